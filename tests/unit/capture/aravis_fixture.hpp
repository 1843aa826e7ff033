#pragma once

#include "site_node/capture/aravis_source.hpp"
#include "tests/support/fake_gige_camera.hpp"
#include "tests/support/network/own_network.hpp"
#include "tests/support/skips.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <condition_variable>
#include <mutex>
#include <thread>

// Fake GigE Vision cameras at loopback addresses, and a player that runs a source of them.
namespace atrium::capture::test {

using std::chrono::milliseconds;
using std::chrono::seconds;
using test_support::FakeGigeCamera;
using testing::HasSubstr;

constexpr int kWidth = 96;
constexpr int kHeight = 64;
constexpr seconds kLongEnough{20};  // for waits well below 1 s, with a sanitizer too

inline config::Rig rig_of(std::size_t num_cameras, double rate_hz) {
    config::Rig rig;
    rig.rate_hz = rate_hz;
    for (std::size_t i = 0; i < num_cameras; ++i) {
        geometry::CalibratedCamera camera;
        camera.name = "cam" + std::to_string(i);
        camera.intrinsics.width = kWidth;
        camera.intrinsics.height = kHeight;
        rig.cameras.push_back(camera);
    }
    return rig;
}

inline std::string address(std::size_t camera) { return "127.0.0." + std::to_string(camera + 2); }
inline std::string serial(std::size_t camera) { return "S" + std::to_string(camera); }

inline FakeGigeCamera::Options fake_options(std::size_t camera) {
    FakeGigeCamera::Options options;
    options.address = address(camera);
    options.serial = serial(camera);
    return options;
}

inline CamerasOptions options_of(std::size_t num_cameras) {
    CamerasOptions options;
    for (std::size_t i = 0; i < num_cameras; ++i)
        options.cameras.push_back({"cam" + std::to_string(i), "", address(i), {}});
    options.common.pixel_format = "Mono8";
    options.trigger = TriggerMode::kFreeRun;
    options.deadline = milliseconds(100);
    options.realtime_priority = 0;
    return options;
}

// Runs a source and records its output.
class Player {
public:
    explicit Player(AravisSource& source, FrameSource::Sink first = {})
        : first_(std::move(first)), thread_([this, &source](std::stop_token stop) {
              result_ = source.run(stop, [this](CameraFrame frame) { take(std::move(frame)); });
          }) {}

    struct Seen {
        std::size_t camera;
        std::uint64_t number;
        Timestamp capture_time;
        bool is_exact;
    };

    // Returns false at the timeout.
    template <typename Condition>
    bool wait(Condition condition, std::chrono::nanoseconds timeout = kLongEnough) {
        std::unique_lock lock(mutex_);
        return changed_.wait_for(lock, timeout, [&] { return condition(seen_); });
    }
    /// Waits for `more` further pictures of the camera.
    bool wait_for_pictures(std::size_t camera, std::size_t more) {
        const std::size_t before = count_of(camera);
        return wait([&](const auto& seen) { return count(seen, camera) >= before + more; });
    }
    std::size_t count_of(std::size_t camera) {
        const std::lock_guard lock(mutex_);
        return count(seen_, camera);
    }
    std::vector<Seen> seen() {
        const std::lock_guard lock(mutex_);
        return seen_;
    }
    /// The pictures that the source reported as lost.
    std::vector<Seen> lost() {
        const std::lock_guard lock(mutex_);
        return lost_;
    }
    std::optional<image::PixelFormat> format() {
        const std::lock_guard lock(mutex_);
        return format_;
    }

private:
    static std::size_t count(const std::vector<Seen>& seen, std::size_t camera) {
        return static_cast<std::size_t>(std::count_if(
            seen.begin(), seen.end(), [&](const Seen& s) { return s.camera == camera; }));
    }

    void take(CameraFrame frame) {
        if (frame.image.empty()) {
            const std::lock_guard lock(mutex_);
            lost_.push_back({frame.camera, 0, frame.capture_time, false});
            return;
        }
        const auto& plane = frame.image.planes[0];
        const std::uint64_t number = FakeGigeCamera::number_in(plane.data);
        const std::size_t row_bytes = image::row_bytes(frame.image.format, frame.image.width);
        bool is_exact = frame.image.width == kWidth && frame.image.height == kHeight &&
                        plane.stride_bytes == row_bytes;
        for (std::size_t i = sizeof(number); i < row_bytes * kHeight && is_exact; ++i)
            is_exact = plane.data[i] == FakeGigeCamera::expected_byte(number, i);
        {
            const std::lock_guard lock(mutex_);
            seen_.push_back({frame.camera, number, frame.capture_time, is_exact});
            format_ = frame.image.format;
        }
        changed_.notify_all();
        if (first_) first_(std::move(frame));
    }

    FrameSource::Sink first_;
    std::mutex mutex_;
    std::condition_variable changed_;
    std::vector<Seen> seen_;
    std::vector<Seen> lost_;
    std::optional<image::PixelFormat> format_;
    Expected<void> result_;
    std::jthread thread_;
};

class AravisSourceTest : public testing::Test {
protected:
    void SetUp() override {
        if (const std::string& reason = test_support::reason_without_own_network();
            !reason.empty()) {
            GTEST_SKIP() << atrium::test::skip::kNoNetwork << reason;
        }
    }

    FakeGigeCamera& add_fake(const FakeGigeCamera::Options& options) {
        fakes_.push_back(std::make_unique<FakeGigeCamera>(options));
        EXPECT_TRUE(fakes_.back()->is_running()) << options.address;
        return *fakes_.back();
    }

    Expected<std::unique_ptr<AravisSource>> open(const CamerasOptions& options,
                                                 double rate_hz = 20.0,
                                                 std::size_t num_cameras = 0) {
        const auto rig = rig_of(num_cameras == 0 ? options.cameras.size() : num_cameras, rate_hz);
        const auto keep = [this](bool is_warning, const std::string& line) {
            {
                const std::lock_guard lock(events_mutex_);
                events_.push_back((is_warning ? "warn " : "info ") + line);
            }
            events_changed_.notify_all();
        };
        return AravisSource::open(rig, options, keep, stop_.get_token());
    }

    void forget_events() {
        const std::lock_guard lock(events_mutex_);
        events_.clear();
    }
    bool wait_for_event(const std::string& part) { return wait_for_events(part, 1); }

    bool wait_for_events(const std::string& part, std::size_t count) {
        std::unique_lock lock(events_mutex_);
        return events_changed_.wait_for(
            lock, kLongEnough, [&] { return count_events(part) >= count; });
    }

    std::size_t num_events(const std::string& part) {
        const std::lock_guard lock(events_mutex_);
        return count_events(part);
    }

    /// Needs `events_mutex_` held.
    std::size_t count_events(const std::string& part) const {
        return static_cast<std::size_t>(
            std::count_if(events_.begin(), events_.end(), [&](const std::string& line) {
                return line.find(part) != std::string::npos;
            }));
    }

    std::vector<std::unique_ptr<FakeGigeCamera>> fakes_;
    std::mutex events_mutex_;
    std::condition_variable events_changed_;
    std::vector<std::string> events_;
    std::stop_source stop_;
};

}  // namespace atrium::capture::test
