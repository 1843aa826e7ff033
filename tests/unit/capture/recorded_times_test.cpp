#include "site_node/capture/recorded_times.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdint>

namespace atrium::capture {
namespace {

// Of two cameras at 30 Hz, the second one late.
RecordedTimes times_of(std::size_t num_frames, std::int64_t late_ms) {
    RecordedTimes times;
    for (std::size_t frame = 0; frame < num_frames; ++frame) {
        const auto time = std::int64_t{33'000'000} * static_cast<std::int64_t>(frame);
        times.push_back({time, time + 1'000'000 * late_ms});
    }
    return times;
}

// The times of unsynchronised cameras that began at different instants.
TEST(RecordedTimes, OfFramesThatAreNoInstantsAreRefused) {
    EXPECT_TRUE(check_times(times_of(10, 0), "times.csv"));
    EXPECT_TRUE(check_times(times_of(10, 20), "times.csv")) << "a tolerance may allow it";
    for (const std::int64_t late_ms : {230, -230}) {
        const auto refused = check_times(times_of(10, late_ms), "rec/times.csv");
        ASSERT_FALSE(refused);
        EXPECT_EQ(refused.error().kind, ErrorKind::kInvalidData);
        EXPECT_THAT(refused.error().message,
                    testing::HasSubstr("rec/times.csv: the pictures of one frame are 230 ms apart, "
                                       "those of two frames 33 ms"));
    }
}

TEST(RecordedTimes, AreNotJudgedIfTheyAreFew) {
    EXPECT_TRUE(check_times({}, "times.csv"));
    EXPECT_TRUE(check_times(times_of(1, 230), "times.csv"));
    RecordedTimes one_camera(10, {std::nullopt, std::nullopt});
    for (std::size_t frame = 0; frame < one_camera.size(); ++frame)
        one_camera[frame][0] = static_cast<std::int64_t>(frame);
    EXPECT_TRUE(check_times(one_camera, "times.csv"));
}

}  // namespace
}  // namespace atrium::capture
