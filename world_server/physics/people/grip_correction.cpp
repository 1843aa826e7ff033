#include "world_server/physics/people/grip_correction.hpp"

#include <Eigen/Cholesky>

#include <algorithm>
#include <cmath>

namespace atrium::physics {
namespace {

constexpr float kStickMps = 0.25F;   // largest mean sliding speed of a contact that sticks
constexpr float kStickRadps = 2.0F;  // a ball that rolls along an arm does not stick
constexpr std::size_t kLooseTicks = 10;
// radius around contacts in which the surface is remembered: a hand's length
constexpr float kAroundM = 0.10F;
constexpr std::size_t kMinKept = 24;  // fewer do not determine a pose
constexpr std::size_t kMaxKept = 250;
constexpr int kRounds = 3;
constexpr float kSearchM = 0.025F;
constexpr float kSameFacing = 0.6F;  // cosine
constexpr float kScaleM = 0.008F;    // a point this far off counts half
constexpr float kMinShare = 0.5F;    // smallest share of points that fit
constexpr float kDamping = 0.02F;    // per point: keeps undetermined directions unchanged
constexpr float kLeverM = 0.1F;      // converts rotations to distances
constexpr float kSlippedM = 0.03F;
constexpr float kSlippedRad = 0.3F;
constexpr float kCatchUpS = 0.1F;
constexpr float kMaxMps = 0.2F;
constexpr float kMaxRadps = 1.5F;

Eigen::Vector3f shortened(const Eigen::Vector3f& v, float max_norm) {
    const float norm = v.norm();
    return norm > max_norm ? (v * (max_norm / norm)).eval() : v;
}

}  // namespace

void GripCorrection::forget() {
    kept_.clear();
    last_ = {};
    num_loose_ = 0;
    velocity_.setZero();
    turning_.setZero();
}

bool GripCorrection::sticks(const ContactMotion& motion,
                            std::span<const PersonContact> contacts,
                            const Eigen::Vector3f& surface_turning) {
    if (contacts.empty() || (motion.angular_velocity - surface_turning).norm() > kStickRadps) {
        return false;
    }
    float sum_mps = 0.0F;
    for (const PersonContact& c : contacts) {
        const Eigen::Vector3f offset = c.point - motion.world_from_body.translation();
        sum_mps +=
            (motion.linear_velocity + motion.angular_velocity.cross(offset) - c.velocity).norm();
    }
    return sum_mps < kStickMps * static_cast<float>(contacts.size());
}

void GripCorrection::update(const ContactMotion& motion,
                            const PersonField& person,
                            std::span<const PersonContact> contacts,
                            const Eigen::Vector3f& surface_turning) {
    num_loose_ = sticks(motion, contacts, surface_turning) ? 0 : num_loose_ + 1;
    if (num_loose_ > kLooseTicks) return forget();
    if (!person.is_half_way()) return;
    if (kept_.empty()) return remember(motion, person, contacts, {});
    const Offset offset = find_offset(motion, person);
    if (!offset.is_sure) {
        // the surface looks different, like a hull that turns in front of the cameras
        return remember(motion, person, contacts, last_);
    }
    if (offset.shift.norm() > kSlippedM || offset.turn.norm() > kSlippedRad) {
        forget();
        return remember(motion, person, contacts, {});
    }
    last_ = offset;
    velocity_ = shortened(offset.shift / kCatchUpS, kMaxMps);
    turning_ = shortened(offset.turn / kCatchUpS, kMaxRadps);
}

void GripCorrection::remember(const ContactMotion& motion,
                              const PersonField& person,
                              std::span<const PersonContact> contacts,
                              const Offset& behind) {
    kept_.clear();
    if (num_loose_ > 0) return;
    const Eigen::Vector3f around = Eigen::Vector3f::Constant(kAroundM);
    Eigen::Vector3f low = contacts.front().point;
    Eigen::Vector3f high = low;
    for (const PersonContact& c : contacts) {
        low = low.cwiseMin(c.point);
        high = high.cwiseMax(c.point);
    }
    const Eigen::Isometry3f body_from_world = motion.world_from_body.inverse();
    person.surfels().visit_box(low - around, high + around, [&](const PlacedSurfel& s) {
        const bool is_near = std::any_of(contacts.begin(), contacts.end(), [&](const auto& c) {
            return (c.point - s.position).squaredNorm() < kAroundM * kAroundM;
        });
        if (!is_near) return;
        const Eigen::Vector3f arm = s.position - motion.world_from_body.translation();
        const Eigen::Vector3f place = s.position - behind.shift - behind.turn.cross(arm);
        kept_.push_back({body_from_world * place, body_from_world.linear() * s.normal});
    });
    if (kept_.size() < kMinKept) kept_.clear();
    if (kept_.size() > kMaxKept) {  // thin out evenly
        for (std::size_t i = 0; i < kMaxKept; ++i) kept_[i] = kept_[i * kept_.size() / kMaxKept];
        kept_.resize(kMaxKept);
    }
}

GripCorrection::Offset GripCorrection::find_offset(const ContactMotion& motion,
                                                   const PersonField& person) const {
    using Matrix6 = Eigen::Matrix<float, 6, 6>;
    using Vector6 = Eigen::Matrix<float, 6, 1>;
    const Eigen::Vector3f search = Eigen::Vector3f::Constant(kSearchM);
    const auto num = static_cast<float>(kept_.size());
    Offset offset;
    for (int round = 0; round < kRounds; ++round) {
        Matrix6 lhs = kDamping * num * Matrix6::Identity();
        Vector6 rhs = Vector6::Zero();
        float num_fitting = 0.0F;
        for (const Kept& kept : kept_) {
            const Eigen::Vector3f arm = motion.world_from_body.linear() * kept.position;
            const Eigen::Vector3f normal = motion.world_from_body.linear() * kept.normal;
            const Eigen::Vector3f place =
                motion.world_from_body.translation() + arm + offset.shift + offset.turn.cross(arm);
            const PlacedSurfel* nearest = nullptr;
            float least_sq = kSearchM * kSearchM;
            person.surfels().visit_box(place - search, place + search, [&](const PlacedSurfel& s) {
                const float apart_sq = (s.position - place).squaredNorm();
                if (apart_sq >= least_sq || s.normal.dot(normal) < kSameFacing) return;
                least_sq = apart_sq;
                nearest = &s;
            });
            if (nearest == nullptr) continue;
            const float behind_m = nearest->normal.dot(nearest->position - place);
            const float weight = 1.0F / (1.0F + behind_m * behind_m / (kScaleM * kScaleM));
            num_fitting += weight > 0.5F ? 1.0F : 0.0F;
            Vector6 row;
            row << nearest->normal, arm.cross(nearest->normal) / kLeverM;
            lhs += weight * row * row.transpose();
            rhs += weight * behind_m * row;
        }
        if (num_fitting < kMinShare * num) return {};
        const Vector6 step = lhs.llt().solve(rhs);
        if (!step.allFinite()) return {};
        offset.shift += step.head<3>();
        offset.turn += step.tail<3>() / kLeverM;
    }
    offset.is_sure = true;
    return offset;
}

}  // namespace atrium::physics
