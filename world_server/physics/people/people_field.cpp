#include "world_server/physics/people/people_field.hpp"

#include <algorithm>
#include <cmath>

namespace atrium::physics {
namespace {

// Extent of the surface around a surfel: surfels are 2 cm apart on average, with gaps.
constexpr float kMaxBesideM = 0.022F;
// Weight of squared distance along a surface, relative to distance along its normal, in the choice
// of the surface. Distances along the surface thus count half. Near an edge, sparse samples would
// otherwise favour the wrong side.
constexpr float kBesideWeight = 0.25F;
constexpr float kLeavingMps = 0.5F;  // a point that leaves faster is not touched
// a point less deep than this one tick ago has entered through this side
constexpr float kEnteredM = 0.005F;
constexpr float kSmoothM = 0.035F;   // support radius of the plane around the foot point
constexpr float kSameFacing = 0.7F;  // cosine
constexpr float kFarther = 1.001F;   // factor for rounding
constexpr int kMinSupport = 2;       // a single surfel is an error of the motion estimate

// The surfel on whose side of the person a point is.
struct Side {
    const PlacedSurfel* surfel = nullptr;
    float cost = 0.0F;
    float distance_m = 0.0F;
};

// Finds the side of least cost for which `accept(surfel, distance)` holds. `surfel` is null if
// there is none.
template <typename Accept>
Side find_side(const SurfelGrid& grid, const Eigen::Vector3f& point, const Accept& accept) {
    constexpr float kMaxBesideSq = kMaxBesideM * kMaxBesideM;
    Side best;
    best.cost = kFieldReachM * kFieldReachM;
    // most surfels in these cells are further away than any with a lower cost
    float within_sq = kFarther * (best.cost + (1.0F - kBesideWeight) * kMaxBesideSq);
    grid.visit_ball(point, std::sqrt(within_sq), kFieldReachM, [&](const PlacedSurfel& s) {
        const Eigen::Vector3f offset = point - s.position;
        const float offset_sq = offset.squaredNorm();
        if (offset_sq > within_sq) return;
        const float distance_m = s.normal.dot(offset);
        const float beside_sq = offset_sq - distance_m * distance_m;
        if (beside_sq > kMaxBesideSq) return;
        const float cost = distance_m * distance_m + kBesideWeight * beside_sq;
        if (cost >= best.cost || !accept(s, distance_m)) return;
        best = {&s, cost, distance_m};
        within_sq = kFarther * (cost + (1.0F - kBesideWeight) * kMaxBesideSq);
    });
    return best;
}

}  // namespace

std::uint8_t SurfaceProbe::facing_octants() const {
    static_assert(kFieldReachM <= SurfelGrid::kOctantReachM);
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
        if (opposed_sq > kFacing * kFacing) octants |= 1 << octant;
    }
    return static_cast<std::uint8_t>(octants);
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
    grid_.assign(*shape_, behind, share);
    max_speed_mps_ = share * shape_max_mps_;
    time_to_go_s_ -= moving_s;
    is_placed_ = moving_s <= 0.0;
}

std::optional<SurfacePoint> PersonField::query(const Eigen::Vector3f& point,
                                               const SurfaceProbe& probe) const {
    const Side nearest = find_side(
        grid_, point, [&](const PlacedSurfel& s, float) { return probe.faces(s.normal); });
    if (nearest.surfel == nullptr) return std::nullopt;
    const PlacedSurfel* side = nearest.surfel;
    if (side->normal.dot(probe.velocity - side->velocity) > kLeavingMps) {
        // In front and leaving: no contact. Inside: it entered through another side. Take the
        // nearest side that the point does not leave and that it had not passed one tick ago.
        if (nearest.distance_m >= 0.0F) return std::nullopt;
        const auto tick_s = static_cast<float>(tick_s_);
        const Side entered = find_side(grid_, point, [&](const PlacedSurfel& s, float distance_m) {
            if (distance_m > 0.0F || !probe.faces(s.normal)) return false;
            const float leaving_mps = s.normal.dot(probe.velocity - s.velocity);
            return leaving_mps <= kLeavingMps && distance_m - leaving_mps * tick_s >= -kEnteredM;
        });
        if (entered.surfel == nullptr) return std::nullopt;
        side = entered.surfel;
    }

    // moving least squares over surfels that face the same way around the foot point
    const Eigen::Vector3f foot = point - side->normal * side->normal.dot(point - side->position);
    int num = 0;
    float weights = 0.0F;
    Eigen::Vector3f centre = Eigen::Vector3f::Zero();
    SurfacePoint found{0.0F, Eigen::Vector3f::Zero(), Eigen::Vector3f::Zero()};
    grid_.visit_ball(foot, kSmoothM, kSmoothM, [&](const PlacedSurfel& s) {
        const float share = 1.0F - (s.position - foot).squaredNorm() / (kSmoothM * kSmoothM);
        if (share <= 0.0F || s.normal.dot(side->normal) < kSameFacing) return;
        const float weight = share * share;
        weights += weight;
        ++num;
        centre += weight * (s.position - foot);
        found.normal += weight * s.normal;
        found.velocity += weight * s.velocity;
    });
    if (num < kMinSupport || weights <= 0.0F) return std::nullopt;
    found.normal.normalize();
    found.velocity /= weights;
    found.distance_m = found.normal.dot(point - foot - centre / weights);
    return found;
}

void PeopleField::set_person(const std::string& name, const PersonShape& shape) {
    people_[name].set_shape(shape);
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
