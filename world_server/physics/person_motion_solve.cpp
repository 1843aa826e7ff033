// How regions move: one by itself from a start, and all together.
#include "world_server/physics/motion_match.hpp"
#include "world_server/physics/person_motion.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>

#include <algorithm>

namespace atrium::physics {
namespace {

using motion::kTrialPoints;
using motion::match;
using motion::robust_cost;

constexpr int kRounds = 3;          // of finding correspondences and solving
constexpr int kSweeps = 30;         // of Gauss and Seidel's method
constexpr float kLeast = 0.05F;     // weight of a point that fits badly: it may yet pull a little
constexpr float kDamping = 0.02F;   // pull towards the start, in points' worth per point
constexpr float kHold = 0.002F;     // the same in the end, where neighbours give hold
constexpr float kPull = 0.05F;      // towards what the place did before, in points' worth per point
constexpr float kCoupling = 0.1F;   // in points' worth per pair of points that lie side by side
constexpr float kLetGoM = 0.02F;    // apart by this, couplings and the pull have lost a good part
constexpr float kTurnM = 0.07F;     // a region's radius: compares turns with displacements
constexpr float kTurnAlike = 1.0F;  // of a coupling, on the turns themselves
constexpr float kMaxTurn = 0.5F;    // [rad]
constexpr float kSamePlaceM = 0.1F;  // between where a region was headed and one of the next mesh

Eigen::Matrix3f cross_matrix(const Eigen::Vector3f& v) {
    Eigen::Matrix3f matrix;
    matrix << 0.0F, -v.z(), v.y(), v.z(), 0.0F, -v.x(), -v.y(), v.x(), 0.0F;
    return matrix;
}

Eigen::Vector3f shortened(const Eigen::Vector3f& v, float max_norm) {
    const float norm = v.norm();
    return norm > max_norm ? (v * (max_norm / norm)).eval() : v;
}

}  // namespace

MotionEstimator::Normals MotionEstimator::correspond(const Region& region,
                                                     const Eigen::Vector3f& displacement,
                                                     std::size_t max_points) const {
    Normals sum;
    const std::size_t stride = 1 + (region.num - 1) / max_points;
    float num = 0.0F;
    for (std::size_t i = 0; i < region.num; i += stride) {
        const SurfaceSample& sample = now_->samples()[points_[region.first + i].sample];
        const Eigen::Vector3f place = sample.position - displacement;
        num += 1.0F;
        const auto found = match(*before_, place, sample.normal);
        if (!found) {
            sum.cost += 1.0F;
            continue;
        }
        const Eigen::Vector3f& normal = found->normal;
        const float distance_m = normal.dot(place - found->position);
        const float cost = robust_cost(distance_m);
        const float weight = 1.0F - cost + kLeast;
        sum.cost += cost;
        sum.lhs += weight * normal * normal.transpose();
        sum.rhs += weight * distance_m * normal;
        sum.weight += weight;
    }
    sum.cost /= num;
    return sum;
}

Eigen::Vector3f MotionEstimator::refine(const Region& region,
                                        Eigen::Vector3f displacement,
                                        int rounds) const {
    for (int round = 0; round < rounds; ++round) {
        Normals sum = correspond(region, displacement, kTrialPoints);
        if (sum.weight <= 0.0F) break;
        sum.lhs.diagonal().array() += kDamping * sum.weight;
        displacement += sum.lhs.llt().solve(sum.rhs);
    }
    return displacement;
}

// What the part of the body that is at the region's place did before.
std::optional<Eigen::Vector3f> MotionEstimator::predicted(const Region& region) const {
    const Moved* nearest = nullptr;
    float nearest_sq = kSamePlaceM * kSamePlaceM;
    for (const Moved& moved : previous_) {
        const Eigen::Vector3f headed = moved.centre + moved.displacement;
        const float off_sq = (headed - region.centre).squaredNorm();
        if (off_sq >= nearest_sq) continue;
        nearest_sq = off_sq;
        nearest = &moved;
    }
    if (nearest == nullptr) return std::nullopt;
    return nearest->displacement + nearest->turn.cross(region.centre - nearest->centre);
}

// The state is that of the whole displacement (3) and turn (3), not of a step.
MotionEstimator::Equations MotionEstimator::equations_of(const Region& region) const {
    Equations sum;
    float weights = 0.0F;
    for (std::size_t i = 0; i < region.num; ++i) {
        const SurfaceSample& sample = now_->samples()[points_[region.first + i].sample];
        const Eigen::Vector3f arm = sample.position - region.centre;
        const Eigen::Vector3f place =
            sample.position - region.displacement - region.turn.cross(arm);
        const auto found = match(*before_, place, sample.normal);
        if (!found) continue;
        const float distance_m = found->normal.dot(place - found->position);
        const float weight = 1.0F - robust_cost(distance_m) + kLeast;
        Vector6 row;
        row << found->normal, arm.cross(found->normal);
        sum.lhs += weight * row * row.transpose();
        sum.rhs += weight * distance_m * row;
        weights += weight;
    }
    sum.lhs.diagonal().head<3>().array() += kHold * (weights + 1.0F);
    sum.lhs.diagonal().tail<3>().array() += kHold * (weights + 1.0F) * kTurnM * kTurnM;
    Vector6 state;
    state << region.displacement, region.turn;
    sum.rhs += sum.lhs * state;
    if (const auto before = predicted(region)) {
        const float off_sq = (*before - region.displacement).squaredNorm();
        const float pull =
            kPull * static_cast<float>(region.num) / (1.0F + off_sq / (kLetGoM * kLetGoM));
        sum.lhs.diagonal().head<3>().array() += pull;
        sum.rhs.head<3>() += pull * *before;
    }
    return sum;
}

// A coupling is the sum of what each side expects of the other, were they one piece.
void MotionEstimator::add_couplings(const Region& region, Equations& equations) const {
    for (const Neighbour& neighbour : region.neighbours) {
        const Region& other = regions_[neighbour.region];
        Coupling coupling;
        coupling.other = neighbour.region;
        coupling.arm = other.centre - region.centre;
        const Eigen::Vector3f apart = other.displacement - region.displacement;
        const float apart_sq = 0.5F * ((apart - region.turn.cross(coupling.arm)).squaredNorm() +
                                       (apart - other.turn.cross(coupling.arm)).squaredNorm());
        const float unlike = 1.0F + apart_sq / (kLetGoM * kLetGoM);
        coupling.weight = kCoupling * neighbour.num_pairs / (unlike * unlike);
        const Eigen::Matrix3f cross = cross_matrix(coupling.arm);
        Matrix6& lhs = equations.lhs;
        lhs.diagonal().head<3>().array() += 2.0F * coupling.weight;
        lhs.topRightCorner<3, 3>() -= coupling.weight * cross;
        lhs.bottomLeftCorner<3, 3>() += coupling.weight * cross;
        lhs.bottomRightCorner<3, 3>() -= coupling.weight * cross * cross;
        lhs.diagonal().tail<3>().array() += kTurnAlike * coupling.weight * kTurnM * kTurnM;
        equations.couplings.push_back(coupling);
    }
}

void MotionEstimator::solve_together() {
    std::vector<Equations> equations(regions_.size());
    std::vector<Eigen::LLT<Matrix6>> solvers(regions_.size());
    std::vector<Vector6> states(regions_.size());
    const auto max_step_m = static_cast<float>(options_.max_step_m);
    for (int round = 0; round < kRounds; ++round) {
        for (std::size_t i = 0; i < regions_.size(); ++i) {
            states[i] << regions_[i].displacement, regions_[i].turn;
            equations[i] = equations_of(regions_[i]);
            add_couplings(regions_[i], equations[i]);
            solvers[i].compute(equations[i].lhs);
        }
        for (int sweep = 0; sweep < kSweeps; ++sweep) {
            for (std::size_t i = 0; i < regions_.size(); ++i) {
                Vector6 rhs = equations[i].rhs;
                for (const Coupling& c : equations[i].couplings) {
                    const Eigen::Vector3f displacement = states[c.other].head<3>();
                    const Eigen::Vector3f turn = states[c.other].tail<3>();
                    rhs.head<3>() += c.weight * (2.0F * displacement - turn.cross(c.arm));
                    rhs.tail<3>() += c.weight * (c.arm.cross(displacement) +
                                                 kTurnAlike * kTurnM * kTurnM * turn);
                }
                states[i] = solvers[i].solve(rhs);
            }
        }
        for (std::size_t i = 0; i < regions_.size(); ++i) {
            if (!states[i].allFinite()) continue;
            regions_[i].displacement = shortened(states[i].head<3>(), max_step_m);
            regions_[i].turn = shortened(states[i].tail<3>(), kMaxTurn);
        }
    }
}

}  // namespace atrium::physics
