#include "world_server/physics/hold.hpp"

#include "world_server/physics/rigid/object_body.hpp"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>

namespace atrium::physics {
namespace {

constexpr double kMoved = 1e-9;  // [m/s], [rad/s]; slower is rounding

}  // namespace

Holds::Hold* Holds::find(std::uint32_t object) {
    const auto found = std::find_if(
        holds_.begin(), holds_.end(), [&](const Hold& hold) { return hold.object == object; });
    return found == holds_.end() ? nullptr : &*found;
}

HoldResult Holds::hold(const std::string& holder,
                       std::uint32_t object,
                       const geometry::RigidTransform& goal) {
    const int ticks =
        std::max(1, static_cast<int>(std::lround(options_.timeout_s / options_.tick_s)));
    if (Hold* held = find(object)) {
        if (held->holder != holder) return HoldResult::kHeldByOther;
        held->goal = goal;
        held->ticks_left = ticks;
        return HoldResult::kHeld;
    }
    const auto of_holder = std::count_if(
        holds_.begin(), holds_.end(), [&](const Hold& other) { return other.holder == holder; });
    if (holds_.size() >= options_.max_holds ||
        static_cast<std::size_t>(of_holder) >= options_.max_per_holder)
        return HoldResult::kTooMany;
    Hold hold;
    hold.holder = holder;
    hold.object = object;
    hold.goal = goal;
    hold.ticks_left = ticks;
    holds_.push_back(std::move(hold));
    return HoldResult::kHeld;
}

bool Holds::let_go(const std::string& holder, std::uint32_t object) {
    const Hold* held = find(object);
    if (held == nullptr || held->holder != holder) return false;
    forget(object);
    let_.push_back(object);
    return true;
}

void Holds::let_go_all(const std::string& holder) {
    for (const Hold& hold : holds_) {
        if (hold.holder == holder) let_.push_back(hold.object);
    }
    std::erase_if(holds_, [&](const Hold& hold) { return hold.holder == holder; });
}

void Holds::forget(std::uint32_t object) {
    std::erase_if(holds_, [&](const Hold& hold) { return hold.object == object; });
}

std::string Holds::holder_of(std::uint32_t object) const {
    for (const Hold& hold : holds_) {
        if (hold.object == object) return hold.holder;
    }
    return {};
}

// Sets the pose at the end of this tick, and the velocities that lead there.
void Holds::step(Hold& hold, const geometry::RigidTransform& from) const {
    const double share = 1.0 - std::exp(-options_.follow_hz * options_.tick_s);
    const Eigen::Vector3d way = share * (hold.goal.translation - from.translation);
    const double max_m = options_.max_speed_mps * options_.tick_s;
    const double length = way.norm();
    const Eigen::Vector3d shift = length > max_m ? (way * (max_m / length)).eval() : way;
    Eigen::AngleAxisd turn(hold.goal.rotation * from.rotation.conjugate());
    if (turn.angle() > M_PI) turn.angle() -= 2.0 * M_PI;
    const double max_rad = options_.max_turn_rad_s * options_.tick_s;
    turn.angle() = std::clamp(share * turn.angle(), -max_rad, max_rad);
    hold.next.translation = from.translation + shift;
    hold.next.rotation = (Eigen::Quaterniond(turn) * from.rotation).normalized();
    hold.velocity = shift / options_.tick_s;
    hold.spin = turn.axis() * (turn.angle() / options_.tick_s);
}

bool Holds::begin_tick(const Find& find_object) {
    for (const std::uint32_t object : let_) {
        ObjectBody* body = find_object(object);
        if (body == nullptr || find(object) != nullptr) continue;
        body->set_state({.id = object, .world_from_object = body->state().world_from_object});
    }
    let_.clear();
    bool moves_fixed = false;
    for (Hold& hold : holds_) {
        ObjectBody* body = --hold.ticks_left >= 0 ? find_object(hold.object) : nullptr;
        if (body == nullptr) {
            hold.ticks_left = -1;
            let_.push_back(hold.object);
            continue;
        }
        const geometry::RigidTransform from = body->state().world_from_object;
        step(hold, from);
        if (body->moves())
            // the velocity is for what the object touches; end_tick sets the pose
            body->set_state({hold.object, from, hold.velocity, hold.spin});
        else
            moves_fixed |= hold.velocity.norm() > kMoved || hold.spin.norm() > kMoved;
    }
    std::erase_if(holds_, [](const Hold& hold) { return hold.ticks_left < 0; });
    return moves_fixed;
}

void Holds::end_tick(const Find& find_object) {
    for (const Hold& hold : holds_) {
        ObjectBody* body = find_object(hold.object);
        if (body == nullptr) continue;
        if (body->moves())
            body->set_state({hold.object, hold.next, hold.velocity, hold.spin});
        else
            body->set_state({.id = hold.object, .world_from_object = hold.next});
    }
}

}  // namespace atrium::physics
