#include "site_node/stage_times.hpp"

#include <algorithm>
#include <numeric>
#include <utility>

namespace atrium::site_node {
namespace {

constexpr std::size_t kNumStages = 7;
constexpr std::chrono::seconds kForget{3};
constexpr std::array<const char*, kNumStages> kStageNames{"segmentation",
                                                          "polygons",
                                                          "the hull",
                                                          "the refinement of the hull",
                                                          "the coding of meshes",
                                                          "the coding of textures",
                                                          "waiting for hosts of regions"};
constexpr std::size_t kRefinement = 3;  // in `kStageNames`

}  // namespace

void StageTimes::computed(const SiteFrame& frame) {
    const SiteFrame::Milliseconds& milliseconds = frame.milliseconds;
    const SiteFrame::WorkMilliseconds& work = frame.work_milliseconds;
    const std::lock_guard lock(mutex_);
    const std::array<double, kNumStages> spent{work.segmentation,
                                               work.polygons,
                                               work.hull,
                                               work.refinement,
                                               work.mesh,
                                               work.textures,
                                               work.waiting};
    for (std::size_t i = 0; i < kNumStages; ++i) work_ms_[i] += spent[i];
    silhouettes_.add(from_milliseconds(milliseconds.silhouettes));
    hull_.add(from_milliseconds(milliseconds.hull));
    coding_.add(from_milliseconds(milliseconds.encode));
}

std::optional<StageTimes::Work> StageTimes::largest_work() {
    const std::lock_guard lock(mutex_);
    const double sum = std::accumulate(work_ms_.begin(), work_ms_.end(), 0.0);
    const auto largest = std::max_element(work_ms_.begin(), work_ms_.end());
    if (!(sum > 0.0)) return std::nullopt;
    const auto index = static_cast<std::size_t>(largest - work_ms_.begin());
    const Work work{kStageNames[index],
                    *largest / sum,
                    index + 1 == kNumStages,
                    index == kRefinement ? "set hull.refine = \"off\"" : ""};
    work_ms_ = {};
    return work;
}

void StageTimes::published(std::size_t mesh_bytes,
                           std::size_t texture_bytes,
                           std::chrono::nanoseconds duration,
                           std::chrono::nanoseconds capture_to_publish) {
    const std::lock_guard lock(mutex_);
    publishing_.add(duration);
    capture_to_publish_.add(capture_to_publish);
    has_published_ = true;
    num_mesh_bytes_ += mesh_bytes;
    num_texture_bytes_ += texture_bytes;
}

void StageTimes::update_rates(std::chrono::steady_clock::time_point now) {
    const std::lock_guard lock(mutex_);
    mesh_bytes_per_s_ = mesh_rate_.update(num_mesh_bytes_, now);
    texture_bytes_per_s_ = texture_rate_.update(num_texture_bytes_, now);
    if (std::exchange(has_published_, false)) last_published_ = now;
    if (now - last_published_ >= kForget)
        silhouettes_ = hull_ = coding_ = publishing_ = capture_to_publish_ = LatencyWindow();
}

void StageTimes::put_into(bus::SiteStatus& status) const {
    const std::lock_guard lock(mutex_);
    status.stages = {silhouettes_.quantiles().median_ms,
                     hull_.quantiles().median_ms,
                     coding_.quantiles().median_ms,
                     publishing_.quantiles().median_ms};
    const Quantiles latency = capture_to_publish_.quantiles();
    status.capture_to_publish = {latency.median_ms, latency.p99_ms, latency.num_samples};
    status.mesh_bytes_per_s = mesh_bytes_per_s_;
    status.texture_bytes_per_s = texture_bytes_per_s_;
}

}  // namespace atrium::site_node
