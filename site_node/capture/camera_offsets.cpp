#include "site_node/capture/camera_offsets.hpp"

#include <algorithm>

namespace atrium::capture {

CameraOffsets::CameraOffsets(std::size_t num_cameras, std::chrono::nanoseconds largest)
    : largest_(largest), cameras_(num_cameras) {
    scratch_.reserve(std::max(num_cameras, kWindow));
    medians_.reserve(num_cameras);
}

// For an even number of values, the mean of the two in the middle.
std::int64_t CameraOffsets::median_of_scratch() {
    const auto middle = scratch_.begin() + static_cast<std::ptrdiff_t>(scratch_.size() / 2);
    std::nth_element(scratch_.begin(), middle, scratch_.end());
    if (scratch_.size() % 2 == 1) return *middle;
    const std::int64_t below = *std::max_element(scratch_.begin(), middle);
    return below + (*middle - below) / 2;
}

void CameraOffsets::learn(const std::vector<CameraFrame>& frames) {
    scratch_.clear();
    for (const CameraFrame& frame : frames) {
        if (!frame.is_lost()) scratch_.push_back(trigger_time(frame).ns);
    }
    if (scratch_.size() < 2 || 2 * scratch_.size() <= frames.size()) return;
    const std::int64_t trigger_ns = median_of_scratch();
    for (const CameraFrame& frame : frames) {
        if (frame.is_lost()) continue;
        Camera& camera = cameras_[frame.camera];
        camera.deviations_ns[camera.next] = frame.capture_time.ns - trigger_ns;
        camera.next = (camera.next + 1) % kWindow;
        camera.num_samples = std::min(camera.num_samples + 1, kWindow);
    }
    set_offsets();
}

// Keeps the median of all offsets at 0: otherwise all could drift away together.
void CameraOffsets::set_offsets() {
    medians_.clear();
    for (Camera& camera : cameras_) {
        if (camera.num_samples < kLeastSamples) {
            camera.offset = {};
            continue;
        }
        const auto begin = camera.deviations_ns.begin();
        scratch_.assign(begin, begin + static_cast<std::ptrdiff_t>(camera.num_samples));
        camera.offset = std::chrono::nanoseconds(median_of_scratch());
        medians_.push_back(camera.offset.count());
    }
    if (medians_.empty()) return;
    scratch_.assign(medians_.begin(), medians_.end());
    const std::chrono::nanoseconds middle(median_of_scratch());
    for (Camera& camera : cameras_) {
        if (camera.num_samples >= kLeastSamples)
            camera.offset = std::clamp(camera.offset - middle, -largest_, largest_);
    }
}

}  // namespace atrium::capture
