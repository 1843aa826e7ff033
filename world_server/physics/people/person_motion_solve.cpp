// Solves for the motion of regions: one alone from a start, and all together.
#include "world_server/physics/people/motion_match.hpp"
#include "world_server/physics/people/person_motion.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <utility>

namespace atrium::physics {
namespace {

using motion::distance_along_normal;
using motion::robust_cost;

Float4 to_float4(const Eigen::Vector3f& v) { return Float4{v.x(), v.y(), v.z(), 0.0F}; }
Eigen::Vector3f to_vector(Float4 v) { return {v[0], v[1], v[2]}; }

Eigen::Matrix3f cross_matrix(const Eigen::Vector3f& v) {
    Eigen::Matrix3f matrix;
    matrix << 0.0F, -v.z(), v.y(), v.z(), 0.0F, -v.x(), -v.y(), v.x(), 0.0F;
    return matrix;
}

Eigen::Vector3f shortened(const Eigen::Vector3f& v, float max_norm) {
    const float norm = v.norm();
    return norm > max_norm ? (v * (max_norm / norm)).eval() : v;
}

// Inverts by blocks of 3 x 3 in closed form. Reads the lower left block, not the upper right one.
Eigen::Matrix<float, 6, 6> inverse_of_symmetric(const Eigen::Matrix<float, 6, 6>& m) {
    const Eigen::Matrix3f upper = m.topLeftCorner<3, 3>().inverse();
    const Eigen::Matrix3f lower_left = m.bottomLeftCorner<3, 3>();
    const Eigen::Matrix3f carried = lower_left * upper;
    const Eigen::Matrix3f rest = m.bottomRightCorner<3, 3>() - carried * lower_left.transpose();
    Eigen::Matrix<float, 6, 6> inverse;
    inverse.bottomRightCorner<3, 3>() = rest.inverse();
    inverse.bottomLeftCorner<3, 3>() = -inverse.bottomRightCorner<3, 3>() * carried;
    inverse.topRightCorner<3, 3>() = inverse.bottomLeftCorner<3, 3>().transpose();
    inverse.topLeftCorner<3, 3>() = upper - carried.transpose() * inverse.bottomLeftCorner<3, 3>();
    return inverse;
}

// Squared change of a region's state [m^2]. Rotations count at the radius `turn_m`.
template <typename Twist>
float moved_sq(const Twist& a, const Twist& b, float turn_m) {
    const Float4 way = a.displacement - b.displacement;
    const Float4 turn = a.turn - b.turn;
    return sum(way * way + turn_m * turn_m * turn * turn);
}

bool is_finite(Float4 v) { return bits_of(v - v == 0.0F) == 0xFU; }

}  // namespace

MotionEstimator::Normals MotionEstimator::correspond(const Region& region,
                                                     const Eigen::Vector3f& displacement,
                                                     std::size_t max_points) {
    const float least = options_.solve.least;
    const float scale_m = options_.match.scale_m;
    Normals sum;
    const std::size_t stride = 1 + (region.num - 1) / max_points;
    places_.clear();
    for (std::size_t i = 0; i < region.num; i += stride) {
        const SurfaceSample& sample = now_->samples()[points_[region.first + i].sample];
        places_.push_back({sample.position - displacement, sample.normal});
    }
    match_places(*before_);
    for (std::size_t i = 0; i < places_.size(); ++i) {
        if (matched_[i] == SurfaceIndex::kNone) {
            sum.cost += 1.0F;
            continue;
        }
        const SurfaceSample& found = before_->samples()[matched_[i]];
        const float distance_m = distance_along_normal(found, places_[i].position);
        const float cost = robust_cost(distance_m, scale_m);
        const float weight = 1.0F - cost + least;
        sum.cost += cost;
        sum.lhs += weight * found.normal * found.normal.transpose();
        sum.rhs += weight * distance_m * found.normal;
        sum.weight += weight;
    }
    sum.cost /= static_cast<float>(places_.size());
    return sum;
}

Eigen::Vector3f MotionEstimator::refine(const Region& region,
                                        Eigen::Vector3f displacement,
                                        int rounds) {
    for (int round = 0; round < rounds; ++round) {
        Normals sum = correspond(region, displacement, options_.start.trial_points);
        if (sum.weight <= 0.0F) break;
        sum.lhs.diagonal().array() += options_.solve.damping * sum.weight;
        displacement += sum.lhs.llt().solve(sum.rhs);
    }
    return displacement;
}

// Predicts each region from the previous motion of the body part at its place.
void MotionEstimator::predict() {
    constexpr float kFarM = 1e6F;  // distance from every place
    const std::size_t num_groups = (previous_.size() + kFloat4Size - 1) / kFloat4Size;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        headed_[axis].assign(num_groups * kFloat4Size, kFarM);
        for (std::size_t i = 0; i < previous_.size(); ++i) {
            const auto at = static_cast<Eigen::Index>(axis);
            headed_[axis][i] = previous_[i].centre[at] + previous_[i].displacement[at];
        }
    }
    for (Region& region : regions_) {
        Float4 least_sq = all4(options_.solve.same_place_m * options_.solve.same_place_m);
        Int4 group = {-1, -1, -1, -1};
        for (std::size_t i = 0; i < num_groups; ++i) {
            const Float4 dx = load4(headed_[0].data() + i * kFloat4Size) - region.centre.x();
            const Float4 dy = load4(headed_[1].data() + i * kFloat4Size) - region.centre.y();
            const Float4 dz = load4(headed_[2].data() + i * kFloat4Size) - region.centre.z();
            const Float4 off_sq = dx * dx + dy * dy + dz * dz;
            const Int4 is_nearer = off_sq < least_sq;
            least_sq = is_nearer ? off_sq : least_sq;
            group = is_nearer ? Int4{} + static_cast<std::int32_t>(i) : group;
        }
        std::size_t best = 0;
        for (std::size_t lane = 1; lane < kFloat4Size; ++lane)
            if (least_sq[lane] < least_sq[best]) best = lane;
        if (group[best] < 0) continue;
        const Moved& nearest =
            previous_[static_cast<std::size_t>(group[best]) * kFloat4Size + best];
        region.predicted =
            nearest.displacement + nearest.turn.cross(region.centre - nearest.centre);
    }
}

// Builds the equations of the region's points and previous motion. The state is the whole
// displacement (3) and rotation (3), not a step.
void MotionEstimator::linearise(const Region& region, Equations& equations) {
    const MotionSolveOptions& solve = options_.solve;
    const float scale_m = options_.match.scale_m;
    // columns of the left side; each is followed by its entry of the right side
    std::array<std::array<Float4, 2>, 6> columns{};
    float weights = 0.0F;
    const bool is_at_rest = region.displacement.isZero(0.0F) && region.turn.isZero(0.0F);
    places_.clear();
    for (std::size_t i = 0; i < region.num; ++i) {
        const SurfaceSample& sample = now_->samples()[points_[region.first + i].sample];
        const Eigen::Vector3f arm = sample.position - region.centre;
        places_.push_back(
            {sample.position - region.displacement - region.turn.cross(arm), sample.normal});
    }
    if (!is_at_rest) match_places(*before_);
    for (std::size_t i = 0; i < region.num; ++i) {
        const Point& point = points_[region.first + i];
        const std::uint32_t found = is_at_rest ? point.at_rest : matched_[i];
        if (found == SurfaceIndex::kNone) continue;
        const Eigen::Vector3f arm = now_->samples()[point.sample].position - region.centre;
        const Eigen::Vector3f& normal = before_->samples()[found].normal;
        const float distance_m =
            distance_along_normal(before_->samples()[found], places_[i].position);
        const float weight = 1.0F - robust_cost(distance_m, scale_m) + solve.least;
        const Eigen::Vector3f lever = arm.cross(normal);
        const std::array<float, 6> row{
            normal.x(), normal.y(), normal.z(), lever.x(), lever.y(), lever.z()};
        const Float4 upper{row[0], row[1], row[2], row[3]};
        const Float4 lower{row[4], row[5], distance_m, 0.0F};
        for (std::size_t column = 0; column < 6; ++column) {
            const float scale = weight * row[column];
            columns[column][0] += scale * upper;
            columns[column][1] += scale * lower;
        }
        weights += weight;
    }
    Matrix6& lhs = equations.own_lhs;
    Vector6 rhs;
    for (std::size_t column = 0; column < 6; ++column) {
        const auto at = static_cast<Eigen::Index>(column);
        for (std::size_t row = 0; row < 6; ++row)
            lhs(static_cast<Eigen::Index>(row), at) =
                columns[column][row / kFloat4Size][row % kFloat4Size];
        rhs[at] = columns[column][1][2];
    }
    lhs.diagonal().head<3>().array() += solve.hold * (weights + 1.0F);
    lhs.diagonal().tail<3>().array() += solve.hold * (weights + 1.0F) * solve.turn_m * solve.turn_m;
    Vector6 state;
    state << to_vector(equations.state.displacement), to_vector(equations.state.turn);
    rhs += lhs * state;
    if (region.predicted) {
        const float off_sq = (*region.predicted - region.displacement).squaredNorm();
        const float pull = solve.pull * static_cast<float>(region.num) /
                           (1.0F + off_sq / (solve.let_go_m * solve.let_go_m));
        lhs.diagonal().head<3>().array() += pull;
        rhs.head<3>() += pull * *region.predicted;
    }
    equations.own_rhs = {to_float4(rhs.head<3>()), to_float4(rhs.tail<3>())};
    equations.linearised_at = equations.state;
}

// Adds the couplings. Each one sums what both sides expect of the other if they were one rigid
// piece.
void MotionEstimator::couple(std::size_t index) {
    const MotionSolveOptions& solve = options_.solve;
    const Region& region = regions_[index];
    Equations& equations = equations_[index];
    const Twist& own = equations.state;
    const Float4 centre = to_float4(region.centre);
    float weights = 0.0F;
    Float4 arms{};
    std::array<Float4, 3> products{};  // outer products of the arms, by rows
    for (std::uint32_t n = 0; n < region.num_neighbours; ++n) {
        const Neighbour& neighbour = neighbours_[region.first_neighbour + n];
        const Twist& other = equations_[neighbour.region].state;
        const Float4 arm = to_float4(regions_[neighbour.region].centre) - centre;
        const Float4 apart = other.displacement - own.displacement;
        const Float4 by_own = apart - cross4(own.turn, arm);
        const Float4 by_other = apart - cross4(other.turn, arm);
        const float apart_sq = 0.5F * sum(by_own * by_own + by_other * by_other);
        const float unlike = 1.0F + apart_sq / (solve.let_go_m * solve.let_go_m);
        const float weight = solve.coupling * neighbour.num_pairs / (unlike * unlike);
        const Float4 weighted = weight * arm;
        couplings_[region.first_neighbour + n] = {all4(weight), weighted, yzx(weighted)};
        weights += weight;
        arms += weighted;
        for (std::size_t row = 0; row < 3; ++row) products[row] += weighted[row] * arm;
    }
    // with C the matrix of the cross product with an arm, each adds
    // [2 I, -C; C, -C^2 + turn_alike turn_m^2 I], where -C^2 = |arm|^2 I - arm arm^T
    Matrix6 lhs = equations.own_lhs;
    const Eigen::Matrix3f cross = cross_matrix(to_vector(arms));
    lhs.topRightCorner<3, 3>() -= cross;
    lhs.bottomLeftCorner<3, 3>() += cross;
    lhs.diagonal().head<3>().array() += 2.0F * weights;
    lhs.diagonal().tail<3>().array() += products[0][0] + products[1][1] + products[2][2] +
                                        solve.turn_alike * solve.turn_m * solve.turn_m * weights;
    for (std::size_t row = 0; row < 3; ++row)
        lhs.block<1, 3>(static_cast<Eigen::Index>(3 + row), 3) -= to_vector(products[row]);
    const Matrix6 inverse = inverse_of_symmetric(lhs);
    for (std::size_t column = 0; column < 6; ++column) {
        const auto at = inverse.col(static_cast<Eigen::Index>(column));
        equations.inverse[column] = {to_float4(at.head<3>()), to_float4(at.tail<3>())};
    }
}

// One Gauss-Seidel step of one region. Returns true if its neighbours must update.
bool MotionEstimator::relax(std::size_t index) {
    const MotionSolveOptions& solve = options_.solve;
    const Region& region = regions_[index];
    Equations& own = equations_[index];
    Float4 displacements{};
    Float4 turns{};
    // cross products before their last rotation; see `cross4`
    Float4 turn_by_arm{};
    Float4 arm_by_displacement{};
    for (std::uint32_t n = region.first_neighbour;
         n < region.first_neighbour + region.num_neighbours;
         ++n) {
        const Coupling& c = couplings_[n];
        const Twist& theirs = equations_[neighbours_[n].region].state;
        displacements += c.weight * theirs.displacement;
        turns += c.weight * theirs.turn;
        turn_by_arm += theirs.turn * c.weighted_arm_yzx - yzx(theirs.turn) * c.weighted_arm;
        arm_by_displacement +=
            c.weighted_arm * yzx(theirs.displacement) - c.weighted_arm_yzx * theirs.displacement;
    }
    const Float4 upper = own.own_rhs.displacement + 2.0F * displacements - yzx(turn_by_arm);
    const Float4 lower = own.own_rhs.turn + yzx(arm_by_displacement) +
                         solve.turn_alike * solve.turn_m * solve.turn_m * turns;
    Twist state;
    for (std::size_t i = 0; i < 3; ++i) {
        state.displacement +=
            own.inverse[i].displacement * upper[i] + own.inverse[i + 3].displacement * lower[i];
        state.turn += own.inverse[i].turn * upper[i] + own.inverse[i + 3].turn * lower[i];
    }
    if (!is_finite(state.displacement) || !is_finite(state.turn)) return false;
    own.state = state;
    if (moved_sq(state, own.seen_by_neighbours, solve.turn_m) <= solve.settled_m * solve.settled_m)
        return false;
    own.seen_by_neighbours = state;
    return true;
}

void MotionEstimator::sweep() {
    for (int i = 0; i < options_.solve.max_sweeps; ++i) {
        bool is_settled = true;
        for (std::size_t r = 0; r < regions_.size(); ++r) {
            if (!std::exchange(equations_[r].is_due, false) || !relax(r)) continue;
            is_settled = false;
            for (const Neighbour& n : neighbours_of(regions_[r]))
                equations_[n.region].is_due = true;
        }
        if (is_settled) return;
    }
}

void MotionEstimator::solve_together() {
    const MotionSolveOptions& solve = options_.solve;
    equations_.assign(regions_.size(), {});
    couplings_.resize(neighbours_.size());
    const auto max_step_m = static_cast<float>(options_.max_step_m);
    for (std::size_t i = 0; i < regions_.size(); ++i) {
        equations_[i].state = {to_float4(regions_[i].displacement), to_float4(regions_[i].turn)};
        equations_[i].seen_by_neighbours = equations_[i].state;
    }
    for (int round = 0; round < solve.num_rounds; ++round) {
        for (std::size_t i = 0; i < regions_.size(); ++i)
            if (equations_[i].is_stale) linearise(regions_[i], equations_[i]);
        for (std::size_t i = 0; i < regions_.size(); ++i) {
            const auto neighbours = neighbours_of(regions_[i]);
            const bool has_to =
                equations_[i].is_stale ||
                std::any_of(neighbours.begin(), neighbours.end(), [&](const Neighbour& n) {
                    return equations_[n.region].is_stale;
                });
            if (!has_to) continue;
            couple(i);
            equations_[i].is_due = true;
        }
        sweep();
        for (std::size_t i = 0; i < regions_.size(); ++i) {
            Equations& own = equations_[i];
            Region& region = regions_[i];
            region.displacement = shortened(to_vector(own.state.displacement), max_step_m);
            region.turn = shortened(to_vector(own.state.turn), solve.max_turn);
            own.state = {to_float4(region.displacement), to_float4(region.turn)};
            own.seen_by_neighbours = own.state;
            own.is_stale = moved_sq(own.state, own.linearised_at, solve.turn_m) >
                           solve.same_matches_m * solve.same_matches_m;
        }
    }
}

}  // namespace atrium::physics
