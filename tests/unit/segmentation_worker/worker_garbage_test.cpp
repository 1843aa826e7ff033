#include "tests/support/random.hpp"
#include "tests/unit/segmentation_worker/worker_fixture.hpp"

#include <gtest/gtest.h>

#include <cstring>
#include <memory>
#include <optional>
#include <vector>

namespace atrium::segmentation_worker {
namespace {

using test::FakeConnection;
using test::FakeWorker;

// Each message is what a worker sends instead of its answer to picture 3.
TEST_F(Worker, ThatSendsGarbageIsCutOffAndMayComeAgain) {
    const FakeWorker worker(path_);
    Site site(path_, kLong_ms);
    auto connection = connect(site, worker);
    const auto changed = [&](std::size_t at, std::uint8_t value) {
        auto bytes = connection->message(2, 3);
        bytes[at] = value;
        return bytes;
    };
    const std::vector<std::vector<std::uint8_t>> wrong{
        {1},
        std::vector<std::uint8_t>(23),
        std::vector<std::uint8_t>(25),
        std::vector<std::uint8_t>(5000, 255),
        changed(0, 0),              // kind
        changed(0, 1),              // ready again
        changed(0, 9),              // kind
        changed(4, 2),              // version
        connection->message(2, 2),  // the picture before
        connection->message(2, 4),  // one that does not exist yet
        connection->message(2, ~0ULL),
        changed(16, 65),  // width
        changed(21, 1),   // height
    };
    WorkerCounts expected;
    std::uint64_t number = 0;
    for (const auto& bytes : wrong) {
        while (number % 3 != 2) {
            ASSERT_TRUE(site.offer());
            connection->answer(++number, 255);
            ASSERT_TRUE(site.take());
            ++expected.num_answered;
        }
        ++number;
        ASSERT_TRUE(site.offer());
        while (connection->receive()->number != number) continue;
        auto sent = bytes;
        // numbers are as if this was picture 3
        if (sent.size() == 24 && sent[8] != 255) {
            const std::uint64_t moved = number - 3 + sent[8];
            std::memcpy(sent.data() + 8, &moved, sizeof moved);
        }
        connection->send(sent);
        EXPECT_FALSE(site.take());
        ++expected.num_invalid;
        EXPECT_EQ(site.counts(), expected);
        EXPECT_FALSE(connection->receive());  // cut off
        connection = connect(site, worker);
    }
}

TEST_F(Worker, ThatSendsGarbageBetweenPicturesIsCutOff) {
    const FakeWorker worker(path_);
    Site site(path_, kLong_ms);
    const auto connection = connect(site, worker);
    connection->send(connection->message(2, 0));  // not asked
    EXPECT_FALSE(site.offer());
    EXPECT_FALSE(site.take());
    EXPECT_EQ(site.counts(), (WorkerCounts{.num_invalid = 1}));
}

TEST_F(Worker, MayAnswerBeforeItIsReadyOnlyByBeingCutOff) {
    const FakeWorker worker(path_);
    Site site(path_, kLong_ms);
    EXPECT_FALSE(site.offer());
    const auto connection = worker.accept();
    EXPECT_FALSE(site.offer());  // it is not asked before it is ready
    connection->send(connection->message(2, 1));
    EXPECT_FALSE(site.offer());
    EXPECT_EQ(site.counts(), (WorkerCounts{.num_invalid = 1, .num_absent = 2}));
}

// Whatever a worker sends: every picture counts once, and only true answers become masks.
TEST_F(Worker, MaySendAnythingAtAnyTime) {
    const FakeWorker worker(path_);
    Site site(path_, kShort_ms / 5.0);
    test::Random random(9);
    std::unique_ptr<FakeConnection> connection;
    std::uint64_t num_answered = 0;
    for (std::uint64_t i = 1; i <= 2000; ++i) {
        if (worker.has_visitor()) {
            connection = worker.accept();
            if (test::between(random, 0, 3) > 0) connection->ready();
        }
        const bool is_offered = site.offer();
        std::optional<FakeConnection::Picture> picture;
        if (is_offered) picture = connection->receive();
        for (int num = test::between(random, 0, 2); num > 0 && connection; --num) {
            auto bytes =
                connection->message(static_cast<std::uint32_t>(test::between(random, 1, 3)),
                                    (picture ? picture->number : i) +
                                        static_cast<std::uint64_t>(test::between(random, -1, 1)));
            bytes.resize(static_cast<std::size_t>(test::between(random, 22, 25)));
            connection->send(bytes);
        }
        if (is_offered && test::between(random, 0, 1) == 0) {
            connection->answer(picture->number, 255);
        }
        const bool has_alpha = site.take();
        if (has_alpha) {
            ++num_answered;
            EXPECT_TRUE(is_offered);
        }
        EXPECT_EQ(site.counts().num_pictures(), i);
        EXPECT_EQ(site.counts().num_answered, num_answered);
        if (test::between(random, 0, 20) == 0) connection.reset();
    }
    EXPECT_GT(num_answered, 100u);
    EXPECT_GT(site.counts().num_invalid, 100u);
    EXPECT_GT(site.counts().num_absent, 100u);
}

}  // namespace
}  // namespace atrium::segmentation_worker
