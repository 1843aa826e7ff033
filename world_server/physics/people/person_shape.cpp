#include "world_server/physics/people/person_shape.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <chrono>
#include <cstdint>
#include <utility>

namespace atrium::physics {
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
    motion_.estimate(surface, previous_, displacements_);
    const auto rest_m = static_cast<float>(options_.rest_speed_mps * period_s);
    const auto max_m = static_cast<float>(options_.max_speed_mps * period_s);
    for (std::size_t i = 0; i < surfels.size(); ++i) {
        MovingSurfel& surfel = surfels[i];
        Eigen::Vector3f displacement = displacements_[i];
        const float step_m = displacement.norm();
        if (step_m > max_m) displacement *= max_m / step_m;
        // smooth transition at the rest speed: a hard one would make slow hands stutter
        const float step_sq = step_m * step_m;
        surfel.velocity =
            displacement * (step_sq / ((step_sq + rest_m * rest_m) * static_cast<float>(period_s)));
        surfel.from = surfel.position - displacement;
    }
    put_onto_previous(surfels);
    return surfels;
}

// Moves start points along the normal onto the previous surface: no gap and no jump between meshes.
void PersonShaper::put_onto_previous(std::span<MovingSurfel> surfels) const {
    const float max_off_m = options_.max_off_m;
    std::array<SurfaceSample, 64> places;
    std::array<std::uint32_t, places.size()> found;
    for (std::size_t first = 0; first < surfels.size(); first += places.size()) {
        const std::size_t num = std::min(places.size(), surfels.size() - first);
        const std::span<MovingSurfel> some = surfels.subspan(first, num);
        for (std::size_t i = 0; i < num; ++i) places[i] = {some[i].from, some[i].normal};
        previous_.nearest(
            {places.data(), num}, options_.search_m, options_.same_facing, {found.data(), num});
        for (std::size_t i = 0; i < num; ++i) {
            if (found[i] == SurfaceIndex::kNone) continue;
            const SurfaceSample& before = previous_.samples()[found[i]];
            const float off_m = before.normal.dot(some[i].from - before.position);
            some[i].from -= std::clamp(off_m, -max_off_m, max_off_m) * before.normal;
        }
    }
}

PersonShape PersonShaper::shape(const geometry::TriangleMesh& mesh_world, Timestamp capture_time) {
    PersonShape shape;
    shape.capture_time = capture_time;
    now_.assign(mesh_world, options_.sampling);
    const double period_s = std::chrono::duration<double>(capture_time - previous_time_).count();
    const bool goes_on = has_previous_ && period_s > 0.0 && period_s <= options_.max_period_s;
    if (goes_on) {
        shape.period_s = period_s;
    } else {
        motion_.forget();
    }
    shape.surfels = std::make_shared<const std::vector<MovingSurfel>>(
        goes_on ? moving_surfels(now_, period_s) : still_surfels(now_));
    std::swap(previous_, now_);
    has_previous_ = true;
    previous_time_ = capture_time;
    return shape;
}

void PersonShaper::forget() {
    has_previous_ = false;
    motion_.forget();
}

}  // namespace atrium::physics
