#include "site_node/capture/frame_mailbox.hpp"

#include <gtest/gtest.h>

#include <thread>

namespace atrium::capture {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;
using Clock = std::chrono::steady_clock;
using Outcome = FrameMailbox::Outcome;

class FrameMailboxTest : public testing::Test {
protected:
    static CameraFrame frame(std::size_t camera, std::int64_t time_ns) {
        CameraFrame f;
        f.camera = camera;
        f.capture_time = {time_ns};
        f.image = std::make_shared<const image::YuvImage>(
            image::YuvImage{image::Plane(2, 2), image::Plane(1, 1), image::Plane(1, 1)});
        return f;
    }
    std::vector<std::int64_t> take() {
        std::vector<CameraFrame> frames;
        mailbox_.take(std::stop_token(), milliseconds(0), frames, num_too_old_);
        std::vector<std::int64_t> times;
        for (const CameraFrame& f : frames) times.push_back(f.capture_time.ns);
        return times;
    }

    FrameMailbox mailbox_{3, seconds(10)};
    std::vector<std::uint64_t> num_too_old_ = std::vector<std::uint64_t>(3, 0);
};

TEST_F(FrameMailboxTest, KeepsTheNewestOfEachCamera) {
    mailbox_.listen_to_all();
    EXPECT_EQ(mailbox_.put(frame(0, 10), Clock::now()), Outcome::kTaken);
    EXPECT_EQ(mailbox_.put(frame(2, 9), Clock::now()), Outcome::kTaken);
    EXPECT_EQ(mailbox_.put(frame(0, 20), Clock::now()), Outcome::kReplacedOne);
    EXPECT_EQ(take(), (std::vector<std::int64_t>{9, 20}));
    EXPECT_EQ(take(), std::vector<std::int64_t>{});
}

TEST_F(FrameMailboxTest, LostPictureNeverReplacesAPresentOne) {
    mailbox_.listen_to_all();
    CameraFrame lost = frame(0, 20);
    lost.image = {};
    mailbox_.put(frame(0, 10), Clock::now());
    EXPECT_EQ(mailbox_.put(lost, Clock::now()), Outcome::kTaken);
    EXPECT_EQ(take(), std::vector<std::int64_t>{10});
    mailbox_.put(lost, Clock::now());
    // and none counts as late
    EXPECT_EQ(mailbox_.put(frame(0, 30), Clock::now()), Outcome::kTaken);
    EXPECT_EQ(take(), std::vector<std::int64_t>{30});
}

TEST_F(FrameMailboxTest, NeverDeliversOutdatedPictures) {
    mailbox_.listen_to_all();
    mailbox_.put(frame(0, 1), Clock::now() - seconds(11));
    mailbox_.put(frame(1, 2), Clock::now());
    mailbox_.put(frame(2, 3), Clock::now() - seconds(30));
    EXPECT_EQ(take(), std::vector<std::int64_t>{2});
    EXPECT_EQ(num_too_old_, (std::vector<std::uint64_t>{1, 0, 1}));
}

TEST_F(FrameMailboxTest, ForgetsALostCamera) {
    mailbox_.listen_to_all();
    mailbox_.put(frame(0, 1), Clock::now());
    mailbox_.put(frame(1, 2), Clock::now());
    mailbox_.clear(0);
    EXPECT_EQ(take(), std::vector<std::int64_t>{2});
}

TEST_F(FrameMailboxTest, ReleasesPicturesWithoutAListenerAtOnce) {
    CameraFrame unheard = frame(1, 5);
    const std::weak_ptr<const void> picture = unheard.image.owner;
    EXPECT_EQ(mailbox_.put(std::move(unheard), Clock::now()), Outcome::kNobodyListens);
    EXPECT_TRUE(picture.expired());
    mailbox_.listen_to({1});
    EXPECT_EQ(mailbox_.put(frame(0, 6), Clock::now()), Outcome::kNobodyListens);
    EXPECT_EQ(mailbox_.put(frame(1, 7), Clock::now()), Outcome::kTaken);
    mailbox_.listen_to_all();  // the earlier picture belongs to another listener
    EXPECT_EQ(take(), std::vector<std::int64_t>{});
}

TEST_F(FrameMailboxTest, WakesTheTakerForAPictureOrAStop) {
    mailbox_.listen_to_all();
    std::vector<CameraFrame> frames;
    bool taken = false;
    {
        std::jthread taker([&](std::stop_token stop) {
            taken = mailbox_.take(stop, seconds(60), frames, num_too_old_);
        });
        mailbox_.put(frame(1, 4), Clock::now());
        taker.request_stop();  // the picture arrived before
    }
    EXPECT_EQ(frames.size(), 1u);
    {
        std::jthread taker([&](std::stop_token stop) {
            taken = mailbox_.take(stop, seconds(60), frames, num_too_old_);
        });
    }
    EXPECT_FALSE(taken);
}

}  // namespace
}  // namespace atrium::capture
