#include "site_node/capture/metaframe_assembler.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

namespace atrium::capture {
namespace {

using std::chrono::milliseconds;
using std::chrono::nanoseconds;
using Clock = std::chrono::steady_clock;

constexpr std::int64_t kPeriod_ns = 50'000'000;
constexpr std::int64_t kTolerance_ns = kPeriod_ns / 4;
const AssemblerOptions kOffsetOptions{nanoseconds(kTolerance_ns), milliseconds(100), 0};

// Simulated cameras. Each has a constant offset and a jitter.
class Room {
public:
    Room(std::vector<double> offsets_tol, double jitter_tol, unsigned seed)
        : offsets_tol_(std::move(offsets_tol)), jitter_tol_(jitter_tol), random_(seed) {}

    struct Arrival {
        CameraFrame frame;
        int trigger = 0;
        std::int64_t at_ns = 0;
    };

    Arrival picture(std::size_t camera, int trigger, std::int64_t longest_way_ns) {
        std::uniform_real_distribution<double> one(-1.0, 1.0);
        const double late_tol = offsets_tol_[camera] + jitter_tol_ * one(random_);
        Arrival arrival;
        arrival.trigger = trigger;
        arrival.frame.camera = camera;
        arrival.frame.capture_time = {
            trigger * kPeriod_ns +
            static_cast<std::int64_t>(late_tol * static_cast<double>(kTolerance_ns))};
        arrival.frame.image = image_of(trigger);
        arrival.at_ns =
            trigger * kPeriod_ns + static_cast<std::int64_t>(0.5 * (1.0 + one(random_)) *
                                                             static_cast<double>(longest_way_ns));
        return arrival;
    }

    bool happens(double probability) { return std::bernoulli_distribution(probability)(random_); }

    std::size_t num_cameras() const { return offsets_tol_.size(); }
    double& offset_tol(std::size_t camera) { return offsets_tol_[camera]; }

    // the width encodes the trigger
    static image::RawImage image_of(int trigger) {
        static const std::uint8_t kPixel = 0;
        image::RawImage image;
        image.format = image::PixelFormat::kMono8;
        image.width = trigger;
        image.height = 1;
        image.planes[0] = {&kPixel, 0};
        return image;
    }

private:
    std::vector<double> offsets_tol_;
    double jitter_tol_;
    std::mt19937 random_;
};

// The common trigger of all pictures of a metaframe, or 0 if they belong to several triggers.
int trigger_of(const Metaframe& metaframe) {
    int trigger = 0;
    for (const CameraFrame& frame : metaframe.frames) {
        if (frame.image.empty()) continue;
        if (trigger != 0 && frame.image.width != trigger) return 0;
        trigger = frame.image.width;
    }
    return trigger;
}

double median(std::vector<double> values) {
    std::sort(values.begin(), values.end());
    return 0.5 * (values[values.size() / 2] + values[(values.size() - 1) / 2]);
}

Clock::time_point at(std::int64_t ns) { return Clock::time_point{} + nanoseconds(ns); }

// Sends all triggers in [first, last] in order of arrival. Returns the triggers of the metaframes.
std::vector<int> play(Room& room,
                      MetaframeAssembler& assembler,
                      int first,
                      int last,
                      std::int64_t longest_way_ns = 1'000'000,
                      double lost = 0.0) {
    std::vector<Room::Arrival> arrivals;
    for (int trigger = first; trigger <= last; ++trigger) {
        for (std::size_t camera = 0; camera < room.num_cameras(); ++camera) {
            if (!room.happens(lost))
                arrivals.push_back(room.picture(camera, trigger, longest_way_ns));
        }
    }
    std::stable_sort(arrivals.begin(), arrivals.end(), [](const auto& a, const auto& b) {
        return a.at_ns < b.at_ns;
    });
    std::vector<int> triggers;
    for (Room::Arrival& arrival : arrivals) {
        if (const auto metaframe = assembler.add(std::move(arrival.frame), at(arrival.at_ns)))
            triggers.push_back(trigger_of(*metaframe));
    }
    return triggers;
}

TEST(CameraOffsets, LearnsAnyOffsetWithinTheToleranceAndNeverMixesTriggers) {
    std::mt19937 random(2024);
    for (int round = 0; round < 200; ++round) {
        const std::size_t num_cameras = 2 + random() % 7;
        std::uniform_real_distribution<double> offset(-0.85, 0.85);
        std::vector<double> offsets_tol(num_cameras);
        for (double& o : offsets_tol) o = offset(random);
        constexpr double kJitter_tol = 0.14;
        Room room(offsets_tol, kJitter_tol, random());
        MetaframeAssembler assembler(num_cameras, kOffsetOptions);
        // pictures may overtake those of the next trigger
        const std::int64_t longest_way_ns = kPeriod_ns * 6 / 5;
        const double lost = round % 2 == 0 ? 0.0 : 0.03;
        const auto triggers = play(room, assembler, 1, 200, longest_way_ns, lost);
        int last = 0;
        for (const int trigger : triggers) {
            ASSERT_NE(trigger, 0) << "mixed, round " << round;
            ASSERT_GT(trigger, last);
            last = trigger;
        }
        if (lost > 0.0) continue;
        // incomplete triggers were overtaken by a newer complete one
        ASSERT_GE(triggers.size(), 120u) << "round " << round;
        const double middle_tol = median(offsets_tol);
        for (std::size_t i = 0; i < num_cameras; ++i) {
            const double learned_tol =
                static_cast<double>(assembler.offsets().offset(i).count()) / kTolerance_ns;
            ASSERT_NEAR(
                learned_tol, std::clamp(offsets_tol[i] - middle_tol, -1.0, 1.0), kJitter_tol);
        }
    }
}

TEST(CameraOffsets, LosesNoTriggerToACameraNearTheTolerance) {
    Room room({0.0, 0.05, 0.9, -0.1, -0.9}, 0.05, 7);
    MetaframeAssembler assembler(5, kOffsetOptions);
    EXPECT_EQ(play(room, assembler, 1, 300).size(), 300u);
    EXPECT_EQ(assembler.counters().num_complete, 300u);
}

TEST(CameraOffsets, KeepsTheMiddleOfAllOffsetsAtZero) {
    Room room({0.3, 0.3, 0.3, 0.8, -0.5}, 0.1, 9);
    MetaframeAssembler assembler(5, kOffsetOptions);
    play(room, assembler, 1, 2000);
    std::vector<std::int64_t> offsets_ns;
    for (std::size_t i = 0; i < 5; ++i) offsets_ns.push_back(assembler.offsets().offset(i).count());
    std::sort(offsets_ns.begin(), offsets_ns.end());
    EXPECT_EQ(offsets_ns[2], 0);
    EXPECT_NEAR(static_cast<double>(offsets_ns[4]), 0.5 * kTolerance_ns, 0.05 * kTolerance_ns);
    EXPECT_NEAR(static_cast<double>(offsets_ns[0]), -0.8 * kTolerance_ns, 0.05 * kTolerance_ns);
}

TEST(CameraOffsets, RelearnsACameraThatReturnsWithAnotherOffset) {
    Room room({0.0, 0.0, 0.0, 0.95}, 0.02, 3);
    MetaframeAssembler assembler(4, kOffsetOptions);
    ASSERT_EQ(play(room, assembler, 1, 100).size(), 100u);
    room.offset_tol(3) = -0.95;
    const auto triggers = play(room, assembler, 101, 200);
    EXPECT_EQ(triggers.size(), 100u);
    EXPECT_EQ(std::count(triggers.begin(), triggers.end(), 0), 0);
    EXPECT_NEAR(static_cast<double>(assembler.offsets().offset(3).count()),
                -0.95 * kTolerance_ns,
                0.05 * kTolerance_ns);
}

TEST(CameraOffsets, NeverLearnsOffsetsAboveTheTolerance) {
    Room room({0.0, 0.0, 0.0, 1.6}, 0.02, 3);
    MetaframeAssembler assembler(4, kOffsetOptions);
    ASSERT_EQ(play(room, assembler, 1, 100).size(), 100u);
    EXPECT_EQ(assembler.offsets().offset(3).count(), kTolerance_ns);
    // even after a wrong estimate, a true offset within the tolerance matches immediately
    room.offset_tol(3) = -0.9;
    const auto triggers = play(room, assembler, 101, 200);
    EXPECT_EQ(triggers.size(), 100u);
    EXPECT_EQ(std::count(triggers.begin(), triggers.end(), 0), 0);
}

TEST(CameraOffsets, KeepsTheCaptureTimesOfTheCameras) {
    Room room({0.0, 0.8}, 0.0, 3);
    MetaframeAssembler assembler(2, kOffsetOptions);
    ASSERT_EQ(play(room, assembler, 1, 50).size(), 50u);
    EXPECT_FALSE(assembler.add(room.picture(1, 51, 0).frame, at(51 * kPeriod_ns)));
    const auto metaframe = assembler.add(room.picture(0, 51, 0).frame, at(51 * kPeriod_ns));
    ASSERT_TRUE(metaframe);
    EXPECT_EQ(metaframe->capture_time.ns, 51 * kPeriod_ns);
}

}  // namespace
}  // namespace atrium::capture
