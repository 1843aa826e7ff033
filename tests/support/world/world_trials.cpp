#include "tests/support/world/world_trials.hpp"

#include "core/codec/mesh_codec.hpp"
#include "tests/support/random.hpp"
#include "tests/support/shapes/decode_mesh.hpp"
#include "tests/support/shapes/signed_distance.hpp"

#include <fmt/format.h>
#include <fmt/ostream.h>

#include <cmath>
#include <numbers>
#include <optional>
#include <ostream>

namespace atrium::test {
namespace {

using Eigen::Vector3d;
using geometry::RigidTransform;

constexpr std::uint32_t kFloor = 1;
constexpr std::uint32_t kThing = 2;
constexpr std::uint32_t kStand = 3;
constexpr double kAtLeast = 0.97;   // of a surface's velocity: its true normal is not known better
constexpr double kDensity = 200.0;  // [kg/m^3] of light wood, or of a ball with air in it

FilmOptions film_options(const TrialSetting& setting, std::uint64_t seed) {
    FilmOptions options;
    options.cameras = setting.cameras;
    options.rate_hz = setting.rate_hz;
    options.seed = seed + 1;
    // cameras and simulation start at different times
    options.first_s = 0.001 * static_cast<double>(seed * 7 % 33);
    return options;
}

physics::RigidObject make_thing(Thing kind, double width_m, const RigidTransform& place) {
    physics::RigidObject thing;
    thing.id = kThing;
    thing.size_m = Vector3d::Constant(width_m);
    thing.shape = kind == Thing::kBall ? physics::ObjectShape::kSphere : physics::ObjectShape::kBox;
    const double volume_m3 =
        std::pow(width_m, 3) * (kind == Thing::kBall ? std::numbers::pi / 6.0 : 1.0);
    thing.mass_kg = kDensity * volume_m3;
    thing.world_from_object = place;
    return thing;
}

void add_floor(physics::World& world) {
    physics::RigidObject floor;
    floor.id = kFloor;
    floor.shape = physics::ObjectShape::kPlane;
    world.add(floor);
}

// A post under an object that will be taken.
void add_stand(physics::World& world, const Vector3d& top) {
    physics::RigidObject stand;
    stand.id = kStand;
    stand.shape = physics::ObjectShape::kCylinder;
    stand.size_m = {0.06, 0.06, top.z()};
    stand.world_from_object.translation = {top.x(), top.y(), 0.5 * top.z()};
    world.add(stand);
}

// Compares the place of an object with its target, and writes the trace.
class Watch {
public:
    Watch(const TrialSetting& setting, const physics::World& world)
        : trace_(setting.trace), world_(world), lag_s_(1.0 / setting.rate_hz) {}

    /// Offset in the frame of the grip. Physics shows people one mesh period late.
    Vector3d off(double time_s,
                 const Act& act,
                 const RigidTransform& world_from_site = RigidTransform{}) {
        state_ = state_of(world_, kThing);
        const RigidTransform grip = world_from_site * act.site_from_grip(time_s - lag_s_);
        const Vector3d off = grip.inverse() * state_.world_from_object.translation;
        yaw_rad_ = yaw(grip.rotation.conjugate() * state_.world_from_object.rotation);
        if (trace_ != nullptr && time_s >= next_trace_s_) {
            next_trace_s_ = time_s + 1.0 / 30.0 - 1e-6;
            const Vector3d v = grip.rotation.conjugate() * state_.linear_velocity;
            fmt::print(*trace_,
                       "t {:.3f} off [cm] {:6.1f} {:6.1f} {:6.1f} yaw {:6.1f} velocity {:5.2f} "
                       "{:5.2f} {:5.2f} spin {:5.2f}\n",
                       time_s,
                       100 * off.x(),
                       100 * off.y(),
                       100 * off.z(),
                       yaw_rad_ * 180.0 / std::numbers::pi,
                       v.x(),
                       v.y(),
                       v.z(),
                       state_.angular_velocity.norm());
        }
        return off;
    }
    /// Yaw of the object in the grip's frame, about its vertical.
    double yaw_rad() const { return yaw_rad_; }
    const physics::RigidState& state() const { return state_; }

private:
    static double yaw(const Eigen::Quaterniond& q) {
        const Vector3d x = q * Vector3d::UnitX();
        return std::atan2(x.y(), x.x());
    }

    std::ostream* trace_;
    const physics::World& world_;
    double lag_s_;
    physics::RigidState state_;
    double yaw_rad_ = 0.0;
    double next_trace_s_ = 0.0;
};

std::string in_cm(const Vector3d& off) {
    return fmt::format("[{:.0f} {:.0f} {:.0f}] cm", 100 * off.x(), 100 * off.y(), 100 * off.z());
}

std::optional<std::string> refusal(const PeopleTrial& trial) {
    if (trial.refused().empty()) return std::nullopt;
    return "a mesh was refused: " + trial.refused().front();
}

}  // namespace

Expected<TrialResult> try_carry(const TrialSetting& setting,
                                const CarryAct& carry,
                                Thing thing,
                                std::uint64_t seed) {
    const auto hulls = film(carry.act, film_options(setting, seed), setting.cache);
    if (!hulls) return tl::unexpected(hulls.error());
    Random random(8000 + seed);
    const bool has_tray = !carry.act.prop.empty();
    const double width = between(random, 0.08, has_tray ? 0.16 : 0.12);
    const double room = has_tray ? 0.05 : 0.012;
    const double turned = between(random, -std::numbers::pi, std::numbers::pi);
    RigidTransform start = carry.act.site_from_grip(0.0);
    start.translation += Vector3d(between(random, -room, room),
                                  between(random, -room, room),
                                  0.5 * width + between(random, 0.02, 0.05));
    start.rotation = Eigen::AngleAxisd(turned, Vector3d::UnitZ());
    physics::World world(setting.world);
    add_floor(world);
    world.add(make_thing(thing, width, start));
    PeopleTrial trial(world, setting.world.tick_s, {{"alice", {}, &*hulls}});
    Watch watch(setting, world);
    TrialResult result;
    const double sideways_limit = has_tray ? 0.20 : 0.12;
    Vector3d off = Vector3d::Zero();
    double lost_s = 0.0;
    bool rested = true;
    trial.run(carry.act.seconds, [&](double time_s) {
        // nobody is there before the first hull, and then an object above the hull's top falls onto
        // it
        off = watch.off(time_s, carry.act);
        result.measure = off.head<2>().norm();
        const bool lies = off.z() > -0.05 && result.measure < sideways_limit;
        if (!lies && lost_s == 0.0) lost_s = time_s;
        if (!lies && time_s < carry.start_s) rested = false;
    });
    if (const auto refused = refusal(trial)) {
        result.reason = *refused;
    } else if (lost_s > 0.0) {
        result.reason = fmt::format("{} at {:.2f} s of {:.2f}..{:.2f}, at the end {}",
                                    rested ? "lost" : "did not come to rest",
                                    lost_s,
                                    carry.start_s,
                                    carry.end_s,
                                    in_cm(off));
    } else if (off.z() > 0.5 * width + 0.12) {
        result.reason = fmt::format("hovers or flies, {}", in_cm(off));
    }
    result.succeeded = result.reason.empty();
    return result;
}

Expected<TrialResult> try_clasp(const TrialSetting& setting, const ClaspAct& clasp, Thing thing) {
    const auto hulls = film(clasp.act, film_options(setting, 1), setting.cache);
    if (!hulls) return tl::unexpected(hulls.error());
    const RigidTransform start = clasp.act.site_from_grip(0.0);
    physics::World world(setting.world);
    add_floor(world);
    add_stand(world, start.translation - Vector3d(0.0, 0.0, 0.5 * clasp.width_m));
    world.add(make_thing(thing, clasp.width_m, start));
    PeopleTrial trial(world, setting.world.tick_s, {{"alice", {}, &*hulls}});
    Watch watch(setting, world);
    TrialResult result;
    double lost_s = 0.0;
    Vector3d off = Vector3d::Zero();
    trial.run(clasp.act.seconds, [&](double time_s) {
        off = watch.off(time_s, clasp.act);
        if (time_s < clasp.lifted_s) return;
        result.measure = std::max(result.measure, off.norm());
        if (off.norm() > 0.08 && lost_s == 0.0) lost_s = time_s;
    });
    const double yaw_deg = watch.yaw_rad() * 180.0 / std::numbers::pi;
    if (const auto refused = refusal(trial)) {
        result.reason = *refused;
    } else if (lost_s > 0.0) {
        result.reason = fmt::format(
            "off the middle at {:.2f} s (closed {:.2f}, moves {:.2f}..{:.2f}), at the end {}",
            lost_s,
            clasp.closed_s,
            clasp.lifted_s,
            clasp.end_s,
            in_cm(off));
    } else if (std::abs(yaw_deg) > 25.0) {
        result.reason = fmt::format("has turned {:.0f} degrees against the hands", yaw_deg);
    }
    result.succeeded = result.reason.empty();
    return result;
}

Expected<TrialResult> try_hand_over(const TrialSetting& setting,
                                    const HandOverAct& act,
                                    Thing thing) {
    const auto giver = film(act.giver, film_options(setting, 1), setting.cache);
    if (!giver) return tl::unexpected(giver.error());
    const auto taker = film(act.taker, film_options(setting, 2), setting.cache);
    if (!taker) return tl::unexpected(taker.error());
    const RigidTransform start = act.world_from_giver * act.giver.site_from_grip(0.0);
    physics::World world(setting.world);
    add_floor(world);
    add_stand(world, start.translation - Vector3d(0.0, 0.0, 0.5 * act.width_m));
    world.add(make_thing(thing, act.width_m, start));
    PeopleTrial trial(
        world,
        setting.world.tick_s,
        {{"alice", act.world_from_giver, &*giver}, {"bob", act.world_from_taker, &*taker}});
    Watch watch(setting, world);
    TrialResult result;
    double lost_s = 0.0;
    std::string lost_by;
    Vector3d off = Vector3d::Zero();
    trial.run(act.end_s + 0.4, [&](double time_s) {
        const bool is_taken = time_s > act.taken_s;
        off = is_taken ? watch.off(time_s, act.taker, act.world_from_taker)
                       : watch.off(time_s, act.giver, act.world_from_giver);
        result.measure = off.norm();
        if (off.norm() < 0.08 || lost_s > 0.0) return;
        lost_s = time_s;
        lost_by = is_taken ? "taker" : "giver";
    });
    if (const auto refused = refusal(trial)) {
        result.reason = *refused;
    } else if (result.measure > 0.08) {
        result.reason = fmt::format(
            "lost by the {} at {:.2f} s (taken {:.2f}, opened {:.2f}, ends {:.2f}), at the end {}",
            lost_by,
            lost_s,
            act.taken_s,
            act.opened_s,
            act.end_s,
            in_cm(off));
    }
    result.succeeded = result.reason.empty();
    return result;
}

Expected<TrialResult> try_throw(const TrialSetting& setting, const ThrowAct& act) {
    const auto hulls = film(act.act, film_options(setting, 1), setting.cache);
    if (!hulls) return tl::unexpected(hulls.error());
    const RigidTransform start = act.act.site_from_grip(0.0);
    physics::World world(setting.world);
    add_floor(world);
    add_stand(world, start.translation - Vector3d(0.0, 0.0, 0.5 * act.width_m));
    world.add(make_thing(Thing::kBall, act.width_m, start));
    PeopleTrial trial(world, setting.world.tick_s, {{"alice", {}, &*hulls}});
    Watch watch(setting, world);
    Vector3d velocity = Vector3d::Zero();
    trial.run(act.act.seconds, [&](double time_s) {
        watch.off(time_s, act.act);
        if (time_s < act.release_s + 0.2) velocity = watch.state().linear_velocity;
    });
    TrialResult result;
    const double forwards = velocity.dot(act.forwards_site);
    // the object has fallen for a moment: the hands did not cause its loss of level flight
    const Vector3d level(velocity.x(), velocity.y(), 0.0);
    const double aside = std::acos(std::clamp(forwards / std::max(1e-9, level.norm()), -1.0, 1.0));
    result.measure = forwards / act.speed_mps;
    if (const auto refused = refusal(trial))
        result.reason = *refused;
    else if (result.measure < 0.6 || result.measure > 2.2)
        result.reason = fmt::format("{:.2f} m/s forwards of {:.2f}", forwards, act.speed_mps);
    else if (aside * 180.0 / std::numbers::pi > 35.0)
        result.reason = fmt::format("{:.0f} degrees aside", aside * 180.0 / std::numbers::pi);
    result.succeeded = result.reason.empty();
    return result;
}

Expected<TrialResult> try_kick(const TrialSetting& setting, const KickAct& act) {
    const auto hulls = film(act.act, film_options(setting, 1), setting.cache);
    if (!hulls) return tl::unexpected(hulls.error());
    RigidTransform start;
    start.translation = act.ball_site;
    physics::World world(setting.world);
    add_floor(world);
    world.add(make_thing(Thing::kBall, act.diameter_m, start));
    PeopleTrial trial(world, setting.world.tick_s, {{"alice", {}, &*hulls}});
    Watch watch(setting, world);
    TrialResult result;
    double fastest = 0.0;
    trial.run(act.act.seconds, [&](double time_s) {
        watch.off(time_s, act.act);
        fastest = std::max(fastest, watch.state().linear_velocity.dot(act.forwards_site));
    });
    result.measure = fastest / act.speed_mps;
    if (const auto refused = refusal(trial))
        result.reason = *refused;
    else if (result.measure < 0.8 || result.measure > 2.2)
        result.reason = fmt::format("{:.2f} m/s forwards of {:.2f}", fastest, act.speed_mps);
    result.succeeded = result.reason.empty();
    return result;
}

Expected<StrikeResult> try_strike(const TrialSetting& setting, const StrikeAct& act) {
    const auto hulls = film(act.act, film_options(setting, 1), {});
    if (!hulls) return tl::unexpected(hulls.error());
    constexpr double kDiameterM = 0.05;
    const double period_s = 1.0 / setting.rate_hz;
    physics::WorldOptions options = setting.world;
    options.gravity = Vector3d::Zero();
    options.max_speed_mps = 30.0;
    // there is no floor, and some strikes go downwards
    options.lowest_z_m = -options.half_extent_m;
    physics::World world(options);
    RigidTransform start;
    const RigidTransform at_contact = act.act.site_from_grip(act.contact_s);
    // just in front of the palm's middle at that time, which is the act's target
    start.translation = at_contact.translation + (0.02 + 0.5 * kDiameterM) * act.palm_normal_site;
    world.add(make_thing(Thing::kBall, kDiameterM, start));
    PeopleTrial trial(world, options.tick_s, {{"alice", {}, &*hulls}});
    Watch watch(setting, world);
    StrikeResult result;
    int num_deep = 0;
    Vector3d normal = act.palm_normal_site;  // of the hull where it meets the ball
    bool is_met = false;
    trial.run(act.act.seconds, [&](double time_s) {
        watch.off(time_s, act.act);
        const Vector3d centre = watch.state().world_from_object.translation;
        const RigidTransform shown = act.act.site_from_grip(time_s - period_s);
        if ((centre - shown.translation).norm() > 0.2) {
            num_deep = 0;
            return;
        }
        // the hull that the physics moves towards its place
        const HullFilm::Frame* frame = &hulls->frames.front();
        for (const auto& next : hulls->frames) {
            if (next.capture_s <= time_s - options.tick_s) frame = &next;
        }
        const auto mesh = test::decode_mesh(frame->draco);
        if (!mesh || mesh->empty()) return;
        const Vector3d back =
            act.act.site_from_grip(frame->capture_s).translation - shown.translation;
        const SignedDistance hull(*mesh);
        const double depth = 0.5 * kDiameterM - hull.at(centre + back);
        result.deepest_m = std::max(result.deepest_m, depth);
        num_deep = depth > 0.02 ? num_deep + 1 : 0;
        result.num_deep_ticks = std::max(result.num_deep_ticks, num_deep);
        if (!is_met && watch.state().linear_velocity.norm() > 0.05 * act.velocity_site.norm()) {
            is_met = true;
            normal = hull.direction_out(centre + back);
        }
    });
    result.measure = watch.state().linear_velocity.dot(normal) / act.velocity_site.dot(normal);
    if (const auto refused = refusal(trial))
        result.reason = *refused;
    else if (result.measure < 0.3)
        result.reason = fmt::format("missed, ratio {:.2f}", result.measure);
    else if (result.measure < kAtLeast || result.measure > 2.2)
        result.reason = fmt::format("ratio {:.2f}", result.measure);
    else if (result.num_deep_ticks > 3)
        result.reason = fmt::format(
            "{:.1f} cm inside for {} ticks", 100 * result.deepest_m, result.num_deep_ticks);
    result.succeeded = result.reason.empty();
    return result;
}

}  // namespace atrium::test
