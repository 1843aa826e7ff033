#include "world_server/physics/people/person_contact.hpp"

#include <Eigen/Cholesky>

#include <algorithm>
#include <cmath>

namespace atrium::physics {
namespace {

constexpr float kSlackM = 0.001F;  // of bounds, for rounding

}  // namespace

std::span<const PersonContact> ContactFinder::find(const ContactBody& body,
                                                   const ContactMotion& motion,
                                                   const PersonField& person,
                                                   double tick_s) {
    candidates_.clear();
    selected_.clear();
    const auto tick = static_cast<float>(tick_s);
    gather(motion, person, tick);
    if (near_.empty()) return {};
    for (const BodySample& sample : body.samples) test(body, motion, sample, person, tick);
    select(body.size_m);
    if (!selected_.empty()) find_turning();
    return selected_;
}

// Lists the surfels that could touch the object within the tick, and the velocity bounds of the
// fast ones.
void ContactFinder::gather(const ContactMotion& motion, const PersonField& person, float tick_s) {
    has_fast_ = false;
    near_.clear();
    const float fast_sq = options_.fast_m * options_.fast_m;
    const float own_mps = motion.linear_velocity.norm();
    const float reach_m = person.options().reach_m + tick_s * (own_mps + person.max_speed_mps());
    const Eigen::Vector3f reach = Eigen::Vector3f::Constant(reach_m);
    near_low_ = motion.high;
    near_high_ = motion.low;
    // speed that rotation adds at any point of the object
    const float turning_mps = motion.angular_velocity.norm() * (motion.high - motion.low).norm();
    const Eigen::Vector3f disc =
        Eigen::Vector3f::Constant(options_.disc_m + tick_s * turning_mps + kSlackM);
    person.surfels().visit_box(motion.low - reach, motion.high + reach, [&](const PlacedSurfel& s) {
        near_.push_back(&s);
        near_low_ = near_low_.cwiseMin(s.position);
        near_high_ = near_high_.cwiseMax(s.position);
        const Eigen::Vector3f way = tick_s * (motion.linear_velocity - s.velocity);
        if (way.squaredNorm() <= fast_sq) return;
        // the object cannot meet a surface that it leaves or that is beside its path
        if (s.normal.dot(way) > tick_s * turning_mps + kSlackM) return;
        const Eigen::Vector3f low = motion.low + way.cwiseMin(0.0F) - disc;
        const Eigen::Vector3f high = motion.high + way.cwiseMax(0.0F) + disc;
        if ((s.position.array() < low.array()).any() || (s.position.array() > high.array()).any()) {
            return;
        }
        fast_low_mps_ = has_fast_ ? fast_low_mps_.cwiseMin(s.velocity).eval() : s.velocity;
        fast_high_mps_ = has_fast_ ? fast_high_mps_.cwiseMax(s.velocity).eval() : s.velocity;
        has_fast_ = true;
    });
    near_low_ -= reach;
    near_high_ += reach;
}

// Fits a rigid motion to the velocities of all surfels near the object.
void ContactFinder::find_turning() {
    turning_.setZero();
    Eigen::Vector3f centre = Eigen::Vector3f::Zero();
    Eigen::Vector3f velocity = Eigen::Vector3f::Zero();
    for (const PlacedSurfel* s : near_) {
        centre += s->position;
        velocity += s->velocity;
    }
    const auto num = static_cast<float>(near_.size());
    centre /= num;
    velocity /= num;
    Eigen::Matrix3f inertia =
        num * options_.turning_m * options_.turning_m * Eigen::Matrix3f::Identity();
    Eigen::Vector3f momentum = Eigen::Vector3f::Zero();
    for (const PlacedSurfel* s : near_) {
        const Eigen::Vector3f arm = s->position - centre;
        inertia += arm.squaredNorm() * Eigen::Matrix3f::Identity() - arm * arm.transpose();
        momentum += arm.cross(s->velocity - velocity);
    }
    turning_ = inertia.ldlt().solve(momentum);
}

// Finds the surfel whose disc the point meets first from the front within the tick. Only surfels
// that are too fast for the field's reach.
const PlacedSurfel* ContactFinder::first_on_path(const Eigen::Vector3f& point,
                                                 const SurfaceProbe& probe,
                                                 const ContactMotion& motion,
                                                 const PersonField& person,
                                                 float tick_s) const {
    const float disc_m = options_.disc_m;
    const float fast_sq = options_.fast_m * options_.fast_m;
    const float facing = person.options().facing;
    const Eigen::Vector3f disc = Eigen::Vector3f::Constant(disc_m + kSlackM);
    const Eigen::Vector3f low = tick_s * (probe.velocity - fast_high_mps_);
    const Eigen::Vector3f high = tick_s * (probe.velocity - fast_low_mps_);
    const PlacedSurfel* first = nullptr;
    float first_s = tick_s;
    person.surfels().visit_box(
        point + low.cwiseMin(0.0F) - disc,
        point + high.cwiseMax(0.0F) + disc,
        [&](const PlacedSurfel& s) {
            const Eigen::Vector3f offset = point - s.position;
            const float distance_m = s.normal.dot(offset);
            if (distance_m < 0.0F || !probe.faces(s.normal, facing)) return;
            const Eigen::Vector3f relative = probe.velocity - s.velocity;
            const float closing_mps = -s.normal.dot(relative);
            if (distance_m >= closing_mps * first_s) return;
            const float meeting_s = distance_m / closing_mps;
            if ((offset + meeting_s * relative).squaredNorm() > disc_m * disc_m) return;
            const Eigen::Vector3f way = tick_s * (motion.linear_velocity - s.velocity);
            if (way.squaredNorm() <= fast_sq) return;
            first = &s;
            first_s = meeting_s;
        });
    return first;
}

void ContactFinder::test(const ContactBody& body,
                         const ContactMotion& motion,
                         const BodySample& sample,
                         const PersonField& person,
                         float tick_s) {
    const Eigen::Vector3f centre = motion.world_from_body.translation();
    const auto in_world = [&](const Eigen::Vector3f& v) -> Eigen::Vector3f {
        return body.is_sphere ? v : (motion.world_from_body.linear() * v).eval();
    };
    const Eigen::Vector3f offset = in_world(sample.point);
    const Eigen::Vector3f point = centre + offset;
    if ((point.array() < near_low_.array()).any() || (point.array() > near_high_.array()).any()) {
        return;
    }
    const SurfaceProbe probe{motion.linear_velocity + motion.angular_velocity.cross(offset),
                             in_world(sample.outwards)};
    PersonContact contact;
    const auto found = person.may_find(point, probe) ? person.query(point, probe) : std::nullopt;
    if (found) {
        contact = {point, found->normal, found->velocity, found->distance_m};
    } else if (const PlacedSurfel* surfel =
                   has_fast_ ? first_on_path(point, probe, motion, person, tick_s) : nullptr) {
        contact = {
            point, surfel->normal, surfel->velocity, surfel->normal.dot(point - surfel->position)};
    } else {
        return;
    }
    if (body.is_sphere) {
        const float facing = contact.normal.dot(offset) / body.radius_m;
        if (facing > options_.facing_edge) return;
        if (facing < options_.facing_plane) {
            // move the contact to the sphere's point nearest to the plane
            contact.point = centre - body.radius_m * contact.normal;
            contact.distance_m -= body.radius_m * (1.0F + facing);
        } else {
            contact.is_at_edge = true;
            contact.normal = -offset / body.radius_m;
            contact.distance_m /= -facing;
        }
    }
    const Eigen::Vector3f at_contact =
        motion.linear_velocity + motion.angular_velocity.cross(contact.point - centre);
    contact.after_m =
        contact.distance_m + tick_s * contact.normal.dot(at_contact - contact.velocity);
    if (std::min(contact.distance_m, contact.after_m) > options_.touch_m) return;
    candidates_.push_back(contact);
}

// Selects the deepest contacts first. Edge contacts count only if no plane is on their side.
// Further contacts must be far from the selected ones or face another way.
void ContactFinder::select(float size_m) {
    const auto before = [](const PersonContact& a, const PersonContact& b) {
        return a.is_at_edge != b.is_at_edge ? b.is_at_edge : a.after_m < b.after_m;
    };
    std::stable_sort(candidates_.begin(), candidates_.end(), before);
    const float apart_m = std::max(options_.min_apart_m, 0.2F * size_m);
    for (const PersonContact& c : candidates_) {
        if (selected_.size() == options_.max_contacts) return;
        const bool is_new =
            std::none_of(selected_.begin(), selected_.end(), [&](const PersonContact& other) {
                if (c.is_at_edge) return c.normal.dot(other.normal) > options_.same_side;
                return (c.point - other.point).squaredNorm() < apart_m * apart_m &&
                       c.normal.dot(other.normal) > options_.same_normal;
            });
        if (is_new) selected_.push_back(c);
    }
}

}  // namespace atrium::physics
