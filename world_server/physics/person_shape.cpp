#include "world_server/physics/person_shape.hpp"

#include <algorithm>
#include <cassert>
#include <chrono>
#include <utility>

namespace atrium::physics {
namespace {

constexpr float kSameFacing = 0.5F;  // cosine: normals at most 60 degrees apart
constexpr float kSearchM = 0.05F;    // around the place that the motion gives
constexpr float kMaxOffM = 0.03F;    // that a surfel is brought onto the surface before

}  // namespace

PersonShaper::PersonShaper(const PersonShapeOptions& options)
    : options_(options), motion_(options.motion) {
    assert(options.max_speed_mps > 0.0 && options.rest_speed_mps > 0.0);
}

std::vector<MovingSurfel> PersonShaper::still_surfels(const SurfaceIndex& surface) const {
    std::vector<MovingSurfel> surfels;
    surfels.reserve(surface.samples().size());
    for (const SurfaceSample& s : surface.samples()) {
        surfels.push_back({s.position, s.normal, s.position, Eigen::Vector3f::Zero()});
    }
    return surfels;
}

std::vector<MovingSurfel> PersonShaper::moving_surfels(const SurfaceIndex& surface,
                                                       double period_s) {
    std::vector<MovingSurfel> surfels = still_surfels(surface);
    motion_.estimate(surface, *previous_, displacements_);
    const auto rest_m = static_cast<float>(options_.rest_speed_mps * period_s);
    const auto max_m = static_cast<float>(options_.max_speed_mps * period_s);
    for (std::size_t i = 0; i < surfels.size(); ++i) {
        MovingSurfel& surfel = surfels[i];
        Eigen::Vector3f displacement = displacements_[i];
        const float step_m = displacement.norm();
        if (step_m > max_m) displacement *= max_m / step_m;
        // a smooth step at the rest speed: a hard one would make slow hands stutter
        surfel.velocity = displacement * (step_m * step_m / (step_m * step_m + rest_m * rest_m)) /
                          static_cast<float>(period_s);

        // onto the surface before, along its normal: no gap and no pop from mesh to mesh
        surfel.from = surfel.position - displacement;
        const auto before =
            previous_->nearest(surfel.from, kSearchM, [&](const SurfaceSample& candidate) {
                return candidate.normal.dot(surfel.normal) > kSameFacing;
            });
        if (!before) continue;
        const float off_m = before->normal.dot(surfel.from - before->position);
        surfel.from -= std::clamp(off_m, -kMaxOffM, kMaxOffM) * before->normal;
    }
    return surfels;
}

PersonShape PersonShaper::shape(const geometry::TriangleMesh& mesh_world, Timestamp capture_time) {
    PersonShape shape;
    shape.capture_time = capture_time;
    auto surface = std::make_shared<const SurfaceIndex>(mesh_world, options_.sampling);
    const double period_s = std::chrono::duration<double>(capture_time - previous_time_).count();
    const bool goes_on = previous_ && period_s > 0.0 && period_s <= options_.max_period_s;
    if (goes_on) {
        shape.period_s = period_s;
    } else {
        motion_.forget();
    }
    shape.surfels = std::make_shared<const std::vector<MovingSurfel>>(
        goes_on ? moving_surfels(*surface, period_s) : still_surfels(*surface));
    previous_ = std::move(surface);
    previous_time_ = capture_time;
    return shape;
}

void PersonShaper::forget() {
    previous_.reset();
    motion_.forget();
}

}  // namespace atrium::physics
