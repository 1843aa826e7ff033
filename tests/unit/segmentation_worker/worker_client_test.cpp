#include "site_node/segmentation_worker/worker_client.hpp"

#include "tests/support/pictures/bgr_from_yuv.hpp"
#include "tests/support/random.hpp"
#include "tests/support/temporary_folder.hpp"
#include "tests/unit/segmentation_worker/fake_worker.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <thread>

namespace atrium::segmentation_worker {
namespace {

using atrium::test::FakeConnection;
using atrium::test::FakeWorker;
using testing::Each;

constexpr int kRoomWidth = 64, kRoomHeight = 48;
constexpr std::size_t kPixels = kRoomWidth * kRoomHeight;
constexpr double kShort_ms = 5.0;      // of workers that do not answer
constexpr double kLong_ms = 60'000.0;  // of workers that do

image::YuvImage grey(std::uint8_t luma) {
    return {image::Plane(kRoomWidth, kRoomHeight, luma),
            image::Plane(kRoomWidth / 2, kRoomHeight / 2, 100),
            image::Plane(kRoomWidth / 2, kRoomHeight / 2, 140)};
}

segmentation::BackgroundModel learned_room() {
    segmentation::BackgroundLearner learner;
    EXPECT_TRUE(learner.add(grey(90)));
    return learner.finish(segmentation::SegmentationOptions{}).value();
}

// A camera of a site. The tests are worker and site in turn, in one thread: nothing of either
// waits for the other.
class Site {
public:
    Site(const std::filesystem::path& socket,
         double deadline_ms,
         std::shared_ptr<WorkerTally> tally = nullptr,
         std::chrono::milliseconds retry_after = std::chrono::milliseconds(0))
        : tally_(tally ? std::move(tally) : std::make_shared<WorkerTally>(deadline_ms)),
          client_(WorkerClient::create({socket, deadline_ms, retry_after},
                                       {"north", kRoomWidth, kRoomHeight, {}},
                                       {},
                                       tally_)
                      .value()) {
        mask_.mask = image::Mask(kRoomWidth, kRoomHeight, kBuiltIn);
    }

    WorkerClient& client() { return *client_; }
    WorkerCounts counts() const { return tally_->counts(); }
    WorkerTally& tally() { return *tally_; }

    // Returns whether the worker got it.
    bool offer(std::uint8_t luma = 120) {
        if (!client_->wants_picture()) return false;
        picture_ = grey(luma);
        const auto image = std::make_shared<image::YuvImage>(picture_);
        client_->offer(image::RawImage(image), *image, {1000 + luma}, model_, {});
        return true;
    }
    // Returns whether the mask is the worker's.
    bool take() {
        mask_.mask = image::Mask(kRoomWidth, kRoomHeight, kBuiltIn);
        mask_.forget();
        const bool has_alpha = client_->take({}, mask_);
        client_->keep_last(mask_.mask);
        if (!has_alpha) {
            EXPECT_THAT(mask_.mask.data, Each(kBuiltIn));
        }
        return has_alpha;
    }
    const image::Mask& mask() const { return mask_.mask; }
    const image::YuvImage& picture() const { return picture_; }
    const segmentation::BackgroundModel& model() const { return model_; }

    static constexpr std::uint8_t kBuiltIn = 7;  // no value of a worker's mask

private:
    std::shared_ptr<WorkerTally> tally_;
    std::unique_ptr<WorkerClient> client_;
    segmentation::BackgroundModel model_ = learned_room();
    image::YuvImage picture_;
    image::SparseMask mask_;
};

class Worker : public testing::Test {
protected:
    // A site whose worker is ready.
    std::unique_ptr<FakeConnection> connect(Site& site, const FakeWorker& worker) {
        EXPECT_FALSE(site.client().is_ready());
        auto connection = worker.accept();
        connection->ready();
        EXPECT_TRUE(site.client().is_ready());
        return connection;
    }

    test::TemporaryFolder folder_;
    std::filesystem::path path_ = folder_ / "worker";
};

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
