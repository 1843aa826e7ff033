#pragma once

#include "site_node/capture/metaframe.hpp"

#include <array>
#include <chrono>
#include <cstddef>
#include <vector>

namespace atrium::capture {

/// Learns how much later than its trigger each camera stamps its pictures. Cables, sensors and
/// clocks differ, by about the same amount at each trigger. The offset is the median of the last
/// kWindow deviations from the median of each metaframe; only differences between cameras are
/// meaningful. Not thread-safe; does not allocate after construction.
class CameraOffsets {
public:
    static constexpr std::size_t kWindow = 63;
    static constexpr std::size_t kLeastSamples = 8;  // with fewer, the offset is 0

    /// Offsets are clamped to +-`largest`.
    CameraOffsets(std::size_t num_cameras, std::chrono::nanoseconds largest);

    /// Returns the estimated trigger time of this picture.
    Timestamp trigger_time(const CameraFrame& frame) const {
        return frame.capture_time + -cameras_[frame.camera].offset;
    }

    /// Learns from one metaframe; `frames[i]` belongs to camera i, and frames without image are
    /// missing. Ignores a metaframe that lacks half of its pictures or more.
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
