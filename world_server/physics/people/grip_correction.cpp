#include "world_server/physics/people/grip_correction.hpp"

#include <Eigen/Cholesky>

#include <algorithm>
#include <cmath>

namespace atrium::physics {
namespace {

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
                            const Eigen::Vector3f& surface_turning) const {
    if (contacts.empty() ||
        (motion.angular_velocity - surface_turning).norm() > options_.stick_radps) {
        return false;
    }
    float sum_mps = 0.0F;
    for (const PersonContact& c : contacts) {
        const Eigen::Vector3f offset = c.point - motion.world_from_body.translation();
        sum_mps +=
            (motion.linear_velocity + motion.angular_velocity.cross(offset) - c.velocity).norm();
    }
    return sum_mps < options_.stick_mps * static_cast<float>(contacts.size());
}

void GripCorrection::update(const ContactMotion& motion,
                            const PersonField& person,
                            std::span<const PersonContact> contacts,
                            const Eigen::Vector3f& surface_turning) {
    num_loose_ = sticks(motion, contacts, surface_turning) ? 0 : num_loose_ + 1;
    if (num_loose_ > options_.loose_ticks) return forget();
    if (!person.is_half_way()) return;
    if (kept_.empty()) return remember(motion, person, contacts, {});
    const Offset offset = find_offset(motion, person);
    if (!offset.is_sure) {
        // the surface looks different, like a hull that turns in front of the cameras
        return remember(motion, person, contacts, last_);
    }
    if (offset.shift.norm() > options_.slipped_m || offset.turn.norm() > options_.slipped_rad) {
        forget();
        return remember(motion, person, contacts, {});
    }
    last_ = offset;
    velocity_ = shortened(offset.shift / options_.catch_up_s, options_.max_mps);
    turning_ = shortened(offset.turn / options_.catch_up_s, options_.max_radps);
}

void GripCorrection::remember(const ContactMotion& motion,
                              const PersonField& person,
                              std::span<const PersonContact> contacts,
                              const Offset& behind) {
    kept_.clear();
    if (num_loose_ > 0) return;
    const float around_m = options_.around_m;
    const Eigen::Vector3f around = Eigen::Vector3f::Constant(around_m);
    Eigen::Vector3f low = contacts.front().point;
    Eigen::Vector3f high = low;
    for (const PersonContact& c : contacts) {
        low = low.cwiseMin(c.point);
        high = high.cwiseMax(c.point);
    }
    const Eigen::Isometry3f body_from_world = motion.world_from_body.inverse();
    person.surfels().visit_box(low - around, high + around, [&](const PlacedSurfel& s) {
        const bool is_near = std::any_of(contacts.begin(), contacts.end(), [&](const auto& c) {
            return (c.point - s.position).squaredNorm() < around_m * around_m;
        });
        if (!is_near) return;
        const Eigen::Vector3f arm = s.position - motion.world_from_body.translation();
        const Eigen::Vector3f place = s.position - behind.shift - behind.turn.cross(arm);
        kept_.push_back({body_from_world * place, body_from_world.linear() * s.normal});
    });
    if (kept_.size() < options_.min_kept) kept_.clear();
    const std::size_t max_kept = options_.max_kept;
    if (kept_.size() > max_kept) {  // thin out evenly
        for (std::size_t i = 0; i < max_kept; ++i) kept_[i] = kept_[i * kept_.size() / max_kept];
        kept_.resize(max_kept);
    }
}

GripCorrection::Offset GripCorrection::find_offset(const ContactMotion& motion,
                                                   const PersonField& person) const {
    using Matrix6 = Eigen::Matrix<float, 6, 6>;
    using Vector6 = Eigen::Matrix<float, 6, 1>;
    const float search_m = options_.search_m;
    const float same_facing = options_.same_facing;
    const float scale_sq = options_.scale_m * options_.scale_m;
    const float lever_m = options_.lever_m;
    const Eigen::Vector3f search = Eigen::Vector3f::Constant(search_m);
    const auto num = static_cast<float>(kept_.size());
    Offset offset;
    for (int round = 0; round < options_.num_rounds; ++round) {
        Matrix6 lhs = options_.damping * num * Matrix6::Identity();
        Vector6 rhs = Vector6::Zero();
        float num_fitting = 0.0F;
        for (const Kept& kept : kept_) {
            const Eigen::Vector3f arm = motion.world_from_body.linear() * kept.position;
            const Eigen::Vector3f normal = motion.world_from_body.linear() * kept.normal;
            const Eigen::Vector3f place =
                motion.world_from_body.translation() + arm + offset.shift + offset.turn.cross(arm);
            const PlacedSurfel* nearest = nullptr;
            float least_sq = search_m * search_m;
            person.surfels().visit_box(place - search, place + search, [&](const PlacedSurfel& s) {
                const float apart_sq = (s.position - place).squaredNorm();
                if (apart_sq >= least_sq || s.normal.dot(normal) < same_facing) return;
                least_sq = apart_sq;
                nearest = &s;
            });
            if (nearest == nullptr) continue;
            const float behind_m = nearest->normal.dot(nearest->position - place);
            const float weight = 1.0F / (1.0F + behind_m * behind_m / scale_sq);
            num_fitting += weight > 0.5F ? 1.0F : 0.0F;
            Vector6 row;
            row << nearest->normal, arm.cross(nearest->normal) / lever_m;
            lhs += weight * row * row.transpose();
            rhs += weight * behind_m * row;
        }
        if (num_fitting < options_.min_share * num) return {};
        const Vector6 step = lhs.llt().solve(rhs);
        if (!step.allFinite()) return {};
        offset.shift += step.head<3>();
        offset.turn += step.tail<3>() / lever_m;
    }
    offset.is_sure = true;
    return offset;
}

}  // namespace atrium::physics
