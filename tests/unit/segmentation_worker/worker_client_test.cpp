#include "tests/support/pictures/bgr_from_yuv.hpp"
#include "tests/unit/segmentation_worker/worker_fixture.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <memory>
#include <thread>
#include <vector>

namespace atrium::segmentation_worker {
namespace {

using test::FakeConnection;
using test::FakeWorker;
using testing::Each;

TEST_F(Worker, GetsPictureBackgroundAndLastMask) {
    const FakeWorker worker(path_);
    Site site(path_, kLong_ms);
    const auto connection = connect(site, worker);
    EXPECT_EQ(connection->text(0).substr(0, 8), "ATRMSEGM");
    EXPECT_EQ(connection->text(72), "north");
    EXPECT_EQ(connection->width(), unsigned{kRoomWidth});
    EXPECT_EQ(connection->height(), unsigned{kRoomHeight});
    EXPECT_EQ(connection->number64(16), connection->num_bytes());
    EXPECT_EQ(connection->number32(64), 60'000'000u);

    ASSERT_TRUE(site.offer(50));
    const auto picture = connection->receive();
    ASSERT_TRUE(picture);
    EXPECT_EQ(picture->kind, 2u);
    EXPECT_EQ(picture->number, 1u);
    EXPECT_EQ(picture->capture_time_ns, 1050);
    EXPECT_EQ(picture->background_number, 1u);
    EXPECT_THAT(connection->plane(40, 3),
                testing::ElementsAreArray(test::bgr_from_yuv(site.picture())));
    EXPECT_THAT(connection->plane(32, 3), testing::ElementsAreArray(test::bgr_from_yuv(grey(90))));
    EXPECT_THAT(connection->plane(48, 1), Each(0));

    connection->answer(1, 255);
    ASSERT_TRUE(site.take());
    EXPECT_THAT(site.mask().data, Each(255));
    ASSERT_TRUE(site.offer());
    EXPECT_EQ(connection->receive()->number, 2u);
    EXPECT_THAT(connection->plane(48, 1), Each(255));
    connection->answer(2, 0);
    ASSERT_TRUE(site.take());
    EXPECT_THAT(site.mask().data, Each(0));
    EXPECT_EQ(site.counts(), (WorkerCounts{.num_answered = 2}));
}

TEST_F(Worker, GetsTheBackgroundAnewFromTimeToTime) {
    const FakeWorker worker(path_);
    Site site(path_, kLong_ms);
    const auto connection = connect(site, worker);
    for (std::uint64_t i = 1; i <= WorkerClient::kBackgroundEvery + 1; ++i) {
        ASSERT_TRUE(site.offer());
        EXPECT_EQ(connection->receive()->background_number,
                  i <= WorkerClient::kBackgroundEvery ? 1u : 2u);
        connection->answer(i, 0);
        ASSERT_TRUE(site.take());
    }
}

TEST_F(Worker, CannotTakeTheMemoryAway) {
    const FakeWorker worker(path_);
    Site site(path_, kLong_ms);
    const auto connection = connect(site, worker);
    EXPECT_NE(ftruncate(connection->memory(), 0), 0);
    EXPECT_NE(ftruncate(connection->memory(), static_cast<off_t>(2 * connection->num_bytes())), 0);
}

TEST_F(Worker, MayWriteAnythingIntoTheMemory) {
    const FakeWorker worker(path_);
    Site site(path_, kLong_ms);
    const auto connection = connect(site, worker);
    ASSERT_TRUE(site.offer());
    // header included; the site reads the alpha at the place that it knows
    const std::span<std::uint8_t> alpha = connection->plane(56, 1);
    std::uint8_t* const begin = alpha.data() - connection->number64(56);
    std::fill_n(begin, connection->num_bytes(), std::uint8_t{200});
    connection->send(connection->message(2, 1));
    // the message has its size from the header
    EXPECT_FALSE(site.take());
    EXPECT_EQ(site.counts(), (WorkerCounts{.num_invalid = 1}));
    EXPECT_FALSE(site.offer());
    const auto next = worker.accept();
    EXPECT_EQ(site.counts(), (WorkerCounts{.num_invalid = 1, .num_absent = 1}));
}

TEST_F(Worker, ThatIsLateCostsItsTimeLimitOnce) {
    const FakeWorker worker(path_);
    Site site(path_, kShort_ms);
    const auto connection = connect(site, worker);
    ASSERT_TRUE(site.offer());
    const auto begin = std::chrono::steady_clock::now();
    EXPECT_FALSE(site.take());
    EXPECT_GE(std::chrono::steady_clock::now() - begin, std::chrono::milliseconds(4));
    EXPECT_EQ(site.counts(), (WorkerCounts{.num_late = 1}));

    // still at work: it is not asked, so nobody waits
    for (std::uint64_t i = 2; i < 100; ++i) {
        EXPECT_FALSE(site.offer());
        EXPECT_FALSE(site.take());
        EXPECT_EQ(site.counts(), (WorkerCounts{.num_late = i}));
    }
    // the answer comes too late for its picture, and the worker gets the newest
    EXPECT_EQ(connection->receive()->number, 1u);
    connection->answer(1, 255);
    ASSERT_TRUE(site.offer(33));
    EXPECT_EQ(connection->receive()->number, 2u);
    EXPECT_EQ(connection->plane(40, 3)[0], test::bgr_from_yuv(site.picture())[0]);
    EXPECT_THAT(connection->plane(48, 1), Each(Site::kBuiltIn));
    connection->answer(2, 0);
    ASSERT_TRUE(site.take());
    EXPECT_THAT(site.mask().data, Each(0));
    EXPECT_EQ(site.counts().num_answered, 1u);
}

TEST_F(Worker, MaySayThatItHasNoAnswer) {
    const FakeWorker worker(path_);
    Site site(path_, kLong_ms);
    const auto connection = connect(site, worker);
    ASSERT_TRUE(site.offer());
    connection->send(connection->message(3, 1));
    EXPECT_FALSE(site.take());
    EXPECT_EQ(site.counts(), (WorkerCounts{.num_invalid = 1}));
    ASSERT_TRUE(site.offer());
    connection->answer(2, 255);
    EXPECT_TRUE(site.take());
}

TEST_F(Worker, MayBeAbsentDieAndComeBack) {
    Site site(path_, kLong_ms);
    EXPECT_FALSE(site.offer());
    EXPECT_FALSE(site.take());
    EXPECT_EQ(site.counts(), (WorkerCounts{.num_absent = 1}));
    WorkerCounts expected{.num_absent = 1};
    for (int life = 0; life < 3; ++life) {
        const FakeWorker worker(path_);
        auto connection = connect(site, worker);
        // the last mask of a former worker's time is not that of the picture before
        ASSERT_TRUE(site.offer());
        const std::uint64_t number = connection->receive()->number;
        EXPECT_EQ(number, static_cast<std::uint64_t>(2 * life + 1));
        EXPECT_THAT(connection->plane(48, 1), Each(0));
        connection->answer(number, 255);
        ASSERT_TRUE(site.take());
        ++expected.num_answered;
        ASSERT_TRUE(site.offer());
        connection.reset();  // with the picture
        EXPECT_FALSE(site.take());
        ++expected.num_absent;
        EXPECT_EQ(site.counts(), expected);
    }
    EXPECT_FALSE(site.offer());
    ++expected.num_absent;
    EXPECT_EQ(site.counts(), expected);
}

TEST_F(Worker, IsLookedForAgainOnlyAfterAWhile) {
    Site site(path_, kLong_ms, nullptr, std::chrono::hours(1));
    EXPECT_FALSE(site.offer());
    const FakeWorker worker(path_);
    EXPECT_FALSE(site.offer());
    EXPECT_FALSE(worker.has_visitor());
}

TEST_F(Worker, IsWaitedForAtTheStart) {
    const FakeWorker worker(path_);
    Site site(path_, kLong_ms);
    Site without(folder_ / "nobody", kLong_ms);
    std::jthread process([&] {
        const auto connection = worker.accept();
        connection->ready();
        EXPECT_FALSE(connection->receive());  // until the site closes it
    });
    {
        std::stop_source never;
        connect_at_start(
            {&site.client(), &without.client()}, std::chrono::minutes(1), never.get_token());
    }
    EXPECT_TRUE(site.client().is_ready());
    EXPECT_FALSE(without.client().is_connected());
    connect_at_start({&without.client()}, std::chrono::hours(1), {});  // no worker: no wait
    site = Site(folder_ / "nobody", kLong_ms);
}

// Cameras and workers in threads of their own, with one tally.
TEST_F(Worker, ServesCamerasInParallel) {
    constexpr int kNumCameras = 3;
    constexpr std::uint64_t kNumPictures = 200;
    const auto tally = std::make_shared<WorkerTally>(kLong_ms);
    const FakeWorker worker(path_);
    std::vector<std::jthread> threads;
    std::vector<std::unique_ptr<Site>> sites;
    for (int i = 0; i < kNumCameras; ++i) {
        auto& site = *sites.emplace_back(std::make_unique<Site>(path_, kLong_ms, tally));
        EXPECT_FALSE(site.client().is_ready());
        threads.emplace_back([connection = std::shared_ptr<FakeConnection>(worker.accept())] {
            connection->ready();
            while (const auto picture = connection->receive())
                connection->answer(picture->number, connection->plane(40, 3)[0]);
        });
    }
    connect_at_start({&sites[0]->client(), &sites[1]->client(), &sites[2]->client()},
                     std::chrono::minutes(1),
                     {});
    {
        std::vector<std::jthread> cameras;
        for (const auto& site : sites) {
            cameras.emplace_back([&site = *site] {
                for (std::uint64_t i = 0; i < kNumPictures; ++i) {
                    const std::uint8_t luma = i % 3 == 0 ? 240 : 60;  // bright: all foreground
                    ASSERT_TRUE(site.offer(luma));
                    ASSERT_TRUE(site.take());
                    ASSERT_EQ(site.mask().at(5, 5), i % 3 == 0 ? 255 : 0);
                }
            });
        }
        for (int look = 0; look < 50; ++look) {
            tally->look(std::chrono::steady_clock::now());
            EXPECT_EQ(tally->finding(), "");
            EXPECT_FALSE(tally->line().empty());
        }
    }
    EXPECT_EQ(tally->counts(), (WorkerCounts{.num_answered = kNumCameras * kNumPictures}));
    sites.clear();  // ends the workers
}

TEST(WorkerOptions, HavePathsThatSocketsCanHave) {
    EXPECT_TRUE(check({.socket = {}}));
    EXPECT_TRUE(check({.socket = std::string(107, 'a')}));
    const auto wrong = check({.socket = std::string(108, 'a')});
    ASSERT_FALSE(wrong);
    EXPECT_EQ(wrong.error().kind, ErrorKind::kConfiguration);
}

}  // namespace
}  // namespace atrium::segmentation_worker
