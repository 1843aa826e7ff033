#pragma once

#include "site_node/capture/metaframe.hpp"

#include <array>
#include <chrono>
#include <cstddef>
#include <vector>

namespace atrium::capture {

/// How much later than its trigger each camera says its pictures were taken: cables, sensors and
/// clocks differ, by about the same from trigger to trigger. Learned from metaframes, as the median
/// of the last kWindow deviations from the middle of each; only differences between cameras mean
/// something. Not thread-safe; does not allocate after construction.
class CameraOffsets {
public:
    static constexpr std::size_t kWindow = 63;
    static constexpr std::size_t kLeastSamples = 8;  // before, an offset counts as 0

    /// No offset is believed to be larger than `largest`.
    CameraOffsets(std::size_t num_cameras, std::chrono::nanoseconds largest);

    /// When the trigger of this picture was.
    Timestamp trigger_time(const CameraFrame& frame) const {
        return frame.capture_time + -cameras_[frame.camera].offset;
    }

    /// `frames[i]` is of camera i; those without an image are missing. Ignored where most are.
    void learn(const std::vector<CameraFrame>& frames);

    std::chrono::nanoseconds offset(std::size_t camera) const { return cameras_[camera].offset; }

private:
    struct Camera {
        std::array<std::int64_t, kWindow> deviations_ns{};
        std::size_t num_samples = 0;
        std::size_t next = 0;
        std::chrono::nanoseconds offset{};
    };
    void set_offsets();
    std::int64_t median_of_scratch();

    std::chrono::nanoseconds largest_;
    std::vector<Camera> cameras_;
    std::vector<std::int64_t> scratch_;
    std::vector<std::int64_t> medians_;
};

}  // namespace atrium::capture
