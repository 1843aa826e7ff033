#include "site_node/stage_times.hpp"

namespace atrium::site_node {
namespace {

std::chrono::nanoseconds from_ms(double ms) {
    return std::chrono::nanoseconds(static_cast<std::int64_t>(ms * 1e6));
}

}  // namespace

void StageTimes::computed(const SiteFrame::Milliseconds& milliseconds) {
    const std::lock_guard lock(mutex_);
    silhouettes_.add(from_ms(milliseconds.silhouettes));
    hull_.add(from_ms(milliseconds.hull));
    coding_.add(from_ms(milliseconds.encode));
}

void StageTimes::published(std::size_t mesh_bytes,
                           std::size_t texture_bytes,
                           std::chrono::nanoseconds duration) {
    const std::lock_guard lock(mutex_);
    publishing_.add(duration);
    num_mesh_bytes_ += mesh_bytes;
    num_texture_bytes_ += texture_bytes;
}

void StageTimes::update_rates(std::chrono::steady_clock::time_point now) {
    const std::lock_guard lock(mutex_);
    mesh_bytes_per_s_ = mesh_rate_.update(num_mesh_bytes_, now);
    texture_bytes_per_s_ = texture_rate_.update(num_texture_bytes_, now);
}

void StageTimes::put_into(bus::SiteStatus& status) const {
    const std::lock_guard lock(mutex_);
    status.stages = {silhouettes_.quantiles().median_ms,
                     hull_.quantiles().median_ms,
                     coding_.quantiles().median_ms,
                     publishing_.quantiles().median_ms};
    status.mesh_bytes_per_s = mesh_bytes_per_s_;
    status.texture_bytes_per_s = texture_bytes_per_s_;
}

}  // namespace atrium::site_node
