#include "world_server/physics/people/people_field.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace atrium::physics {
namespace {

constexpr float kFarther = 1.001F;  // factor for rounding

// The surfel on whose side of the person a point is.
struct Side {
    const PlacedSurfel* surfel = nullptr;
    float cost = 0.0F;
    float distance_m = 0.0F;
};

// Finds the side of least cost for which `accept(surfel, distance)` holds. `surfel` is null if
// there is none.
template <typename Accept>
Side find_side(const SurfelGrid& grid,
               const Eigen::Vector3f& point,
               const PeopleFieldOptions& options,
               const Accept& accept) {
    const float reach_m = options.reach_m;
    const float max_beside_sq = options.beside_m * options.beside_m;
    const float beside_weight = options.beside_weight;
    Side best;
    best.cost = reach_m * reach_m;
    // most surfels in these cells are further away than any with a lower cost
    float within_sq = kFarther * (best.cost + (1.0F - beside_weight) * max_beside_sq);
    grid.visit_ball(point, std::sqrt(within_sq), reach_m, [&](const PlacedSurfel& s) {
        const Eigen::Vector3f offset = point - s.position;
        const float offset_sq = offset.squaredNorm();
        if (offset_sq > within_sq) return;
        const float distance_m = s.normal.dot(offset);
        const float beside_sq = offset_sq - distance_m * distance_m;
        if (beside_sq > max_beside_sq) return;
        const float cost = distance_m * distance_m + beside_weight * beside_sq;
        if (cost >= best.cost || !accept(s, distance_m)) return;
        best = {&s, cost, distance_m};
        within_sq = kFarther * (cost + (1.0F - beside_weight) * max_beside_sq);
    });
    return best;
}

}  // namespace

std::uint8_t SurfaceProbe::facing_octants(float facing) const {
    if (outwards.isZero()) return 0xFF;
    const Eigen::Array3f sq = outwards.array().square();
    int octants = 0;
    for (int octant = 0; octant < 8; ++octant) {
        // in each octant, only these components are opposed in the most opposed direction
        float opposed_sq = 0.0F;
        for (int axis = 0; axis < 3; ++axis) {
            const bool is_negative = (octant >> axis & 1) != 0;
            if (is_negative == (outwards[axis] > 0.0F)) opposed_sq += sq[axis];
        }
        if (opposed_sq > facing * facing) octants |= 1 << octant;
    }
    return static_cast<std::uint8_t>(octants);
}

PersonField::PersonField(const PeopleFieldOptions& options) : options_(options) {
    // the octants of a cell are those of the surfels within a cell size
    assert(options.reach_m <= options.cell_m);
}

void PersonField::set_shape(const PersonShape& shape) {
    shape_ = shape.surfels;
    capture_time_ = shape.capture_time;
    period_s_ = time_to_go_s_ = shape.period_s;
    float max_speed_sq = 0.0F;
    for (const MovingSurfel& s : *shape_)
        max_speed_sq = std::max(max_speed_sq, s.velocity.squaredNorm());
    shape_max_mps_ = std::sqrt(max_speed_sq);
    is_placed_ = false;
}

void PersonField::begin_tick(double tick_s) {
    tick_s_ = tick_s;
    is_half_way_ = false;
    if (is_placed_ || !shape_) return;
    const double moving_s = std::min(tick_s, time_to_go_s_);
    const double half_s = 0.5 * period_s_ + 1e-6;  // for rounding
    is_half_way_ = time_to_go_s_ <= half_s && time_to_go_s_ + tick_s > half_s;
    const float behind = share_to_go();
    const auto share = static_cast<float>(moving_s / tick_s);
    grid_.assign(*shape_, behind, share, options_.cell_m);
    max_speed_mps_ = share * shape_max_mps_;
    time_to_go_s_ -= moving_s;
    is_placed_ = moving_s <= 0.0;
}

std::optional<SurfacePoint> PersonField::query(const Eigen::Vector3f& point,
                                               const SurfaceProbe& probe) const {
    const float facing = options_.facing;
    const float most_mps = options_.leaving_mps;
    const Side nearest = find_side(grid_, point, options_, [&](const PlacedSurfel& s, float) {
        return probe.faces(s.normal, facing);
    });
    if (nearest.surfel == nullptr) return std::nullopt;
    const PlacedSurfel* side = nearest.surfel;
    if (side->normal.dot(probe.velocity - side->velocity) > most_mps) {
        // In front and leaving: no contact. Inside: it entered through another side. Take the
        // nearest side that the point does not leave and that it had not passed one tick ago.
        if (nearest.distance_m >= 0.0F) return std::nullopt;
        const auto tick_s = static_cast<float>(tick_s_);
        const float entered_m = options_.entered_m;
        const Side entered =
            find_side(grid_, point, options_, [&](const PlacedSurfel& s, float distance_m) {
                if (distance_m > 0.0F || !probe.faces(s.normal, facing)) return false;
                const float leaving_mps = s.normal.dot(probe.velocity - s.velocity);
                return leaving_mps <= most_mps && distance_m - leaving_mps * tick_s >= -entered_m;
            });
        if (entered.surfel == nullptr) return std::nullopt;
        side = entered.surfel;
    }

    // moving least squares over surfels that face the same way around the foot point
    const Eigen::Vector3f foot = point - side->normal * side->normal.dot(point - side->position);
    const float smooth_m = options_.smooth_m;
    const float same_facing = options_.same_facing;
    int num = 0;
    float weights = 0.0F;
    Eigen::Vector3f centre = Eigen::Vector3f::Zero();
    SurfacePoint found{0.0F, Eigen::Vector3f::Zero(), Eigen::Vector3f::Zero()};
    grid_.visit_ball(foot, smooth_m, smooth_m, [&](const PlacedSurfel& s) {
        const float share = 1.0F - (s.position - foot).squaredNorm() / (smooth_m * smooth_m);
        if (share <= 0.0F || s.normal.dot(side->normal) < same_facing) return;
        const float weight = share * share;
        weights += weight;
        ++num;
        centre += weight * (s.position - foot);
        found.normal += weight * s.normal;
        found.velocity += weight * s.velocity;
    });
    if (num < options_.min_support || weights <= 0.0F) return std::nullopt;
    found.normal.normalize();
    found.velocity /= weights;
    found.distance_m = found.normal.dot(point - foot - centre / weights);
    return found;
}

void PeopleField::set_person(const std::string& name, const PersonShape& shape) {
    people_.try_emplace(name, options_).first->second.set_shape(shape);
}

bool PeopleField::remove_person(const std::string& name) { return people_.erase(name) > 0; }

void PeopleField::begin_tick(double tick_s) {
    for (auto& [name, person] : people_) person.begin_tick(tick_s);
}

std::optional<SurfacePoint> PeopleField::query(const Eigen::Vector3f& p_world,
                                               const SurfaceProbe& probe) const {
    std::optional<SurfacePoint> deepest;
    for (const auto& [name, person] : people_) {
        const auto found = person.query(p_world, probe);
        if (found && (!deepest || found->distance_m < deepest->distance_m)) deepest = found;
    }
    return deepest;
}

}  // namespace atrium::physics
