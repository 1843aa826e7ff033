#include "tests/support/world/endurance.hpp"

#include "simulation/choreography.hpp"
#include "tests/support/world/act_motion.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace atrium::test {
namespace {

constexpr std::array<simulation::Motion, 5> kMotions{simulation::Motion::kWalk,
                                                     simulation::Motion::kPush,
                                                     simulation::Motion::kWave,
                                                     simulation::Motion::kSway,
                                                     simulation::Motion::kRaise};
constexpr double kTurnS = kWanderLoopS / kMotions.size();  // of one motion
constexpr double kLoopS = kTurnS / 2.0;                    // each motion is performed twice
constexpr double kBlendS = 2.0;                            // before the end of each motion
constexpr double kGravity = 9.81;
constexpr double kRounded = 1.0001;  // rounding of a float
constexpr double kPictureS = 1.0 / 30.0;

Eigen::Vector3d mix(const Eigen::Vector3d& a, const Eigen::Vector3d& b, double share) {
    return a + share * (b - a);
}

// Interpolates directions, which may be opposite, along an arc at a constant rate.
Eigen::Vector3d turned(const Eigen::Vector3d& a, const Eigen::Vector3d& b, double share) {
    const auto all = Eigen::Quaterniond::FromTwoVectors(a, b);
    return Eigen::Quaterniond::Identity().slerp(share, all) * a.normalized();
}

simulation::ArmPose mix(const simulation::ArmPose& a, const simulation::ArmPose& b, double share) {
    return {mix(a.wrist, b.wrist, share),
            turned(a.elbow_towards, b.elbow_towards, share),
            turned(a.fingers, b.fingers, share),
            turned(a.palm, b.palm, share)};
}

simulation::LegPose mix(const simulation::LegPose& a, const simulation::LegPose& b, double share) {
    return {mix(a.ankle, b.ankle, share),
            a.toe_down_rad + share * (b.toe_down_rad - a.toe_down_rad)};
}

simulation::BodyPose mix(const simulation::BodyPose& a,
                         const simulation::BodyPose& b,
                         double share) {
    return {mix(a.shift, b.shift, share),
            mix(a.pelvis_turn, b.pelvis_turn, share),
            mix(a.chest_turn, b.chest_turn, share),
            mix(a.head_turn, b.head_turn, share),
            mix(a.right_arm, b.right_arm, share),
            mix(a.left_arm, b.left_arm, share),
            mix(a.right_leg, b.right_leg, share),
            mix(a.left_leg, b.left_leg, share)};
}

simulation::BodyPose wander_pose(double time_s) {
    const double turns = std::fmod(time_s, kWanderLoopS) / kTurnS;
    const auto turn = std::min(static_cast<std::size_t>(turns), kMotions.size() - 1);
    const double in_turn_s = (turns - static_cast<double>(turn)) * kTurnS;
    const double phase = std::fmod(in_turn_s / kLoopS, 1.0);
    const double share = ease(in_turn_s, kTurnS - kBlendS, kBlendS);
    return mix(simulation::posture(kMotions[turn], phase),
               simulation::posture(kMotions[(turn + 1) % kMotions.size()], phase),
               share);
}

}  // namespace

Act wander_act(const std::string& look) {
    Act act;
    act.name = "wander-" + look;
    act.look = look;
    act.seconds = kWanderLoopS - 0.5 * kPictureS;
    act.pose = wander_pose;
    act.site_from_feet = [](double) { return geometry::RigidTransform{}; };
    return act;
}

geometry::RigidTransform wander_place(double time_s, double phase_rad) {
    const auto at = [&](double t) {
        const double a = 0.23 * t + phase_rad;
        return (1.5 * std::cos(1.618 * a) * Eigen::Vector2d(std::cos(a), std::sin(a))).eval();
    };
    const Eigen::Vector2d place = at(time_s);
    const Eigen::Vector2d way = at(time_s + 0.01) - place;
    return upright({place.x(), place.y(), 0.0},
                   std::atan2(way.y(), way.x()) - std::numbers::pi / 2.0);
}

double wander_speed_mps(const Act& act) {
    const ActedPerson person(act);
    double most_mps = 0.0;
    geometry::TriangleMesh before;
    for (double t = 0.0; t < act.seconds; t += kPictureS) {
        geometry::TriangleMesh mesh = person.mesh_site(t);
        for (std::size_t i = 0; i < before.vertices.size(); ++i) {
            const double way_m = (mesh.vertices[i] - before.vertices[i]).norm();
            most_mps = std::max(most_mps, way_m / kPictureS);
        }
        before = std::move(mesh);
    }
    return most_mps + 0.7;
}

WorldWatch::WorldWatch(world_server::Scene& scene,
                       const std::vector<physics::Joint>& joints,
                       const EnduranceBounds& bounds)
    : scene_(scene), bounds_(bounds) {
    const double hit_mps = bounds.hit_factor * bounds.people_mps;
    most_specific_ = 0.5 * hit_mps * hit_mps + kGravity * bounds.reach_m;
    for (const bus::SceneObject& object : scene.objects()) {
        const Eigen::Vector3d sq = object.size_m.cwiseAbs2();
        things_[object.object] = {
            object.name,
            object.mass_kg,
            object.mass_kg / 12.0 *
                Eigen::Vector3d(sq.y() + sq.z(), sq.z() + sq.x(), sq.x() + sq.y()),
            object.object};
        const double height = std::max(bounds.head_m, object.world_from_object.translation.z());
        figures_.energy_bound_j +=
            object.mass_kg * (kGravity * height + 0.5 * bounds.people_mps * bounds.people_mps);
    }
    for (const physics::Joint& joint : joints) join(joint);
    contact_ticks_ = scene.world().counters().num_contact_ticks;
}

void WorldWatch::join(const physics::Joint& joint) {
    const auto a = things_.find(joint.a);
    const auto b = things_.find(joint.b);
    if (a == things_.end() || b == things_.end()) return;  // joined to the world
    if (a->second.mass_kg <= 0.0 || b->second.mass_kg <= 0.0) return;
    const std::uint32_t from = a->second.whole;
    const std::uint32_t to = b->second.whole;
    for (auto& [id, thing] : things_)
        if (thing.whole == from) thing.whole = to;
}

// Keeps the first value above its bound or not a number.
void WorldWatch::note(double value, double bound, const std::string& what, double time_s) {
    if (value <= bound || !figures_.broken.empty()) return;
    figures_.broken =
        fmt::format("{}: {:.3g}, allowed {:.3g}, after {:.2f} s", what, value, bound, time_s);
}

double WorldWatch::look_at_rigid(double time_s) {
    scene_.world().get_states(rigid_);
    double energy_j = 0.0;
    wholes_.clear();
    for (const physics::RigidState& state : rigid_) {
        const Thing& thing = things_.at(state.id);
        if (thing.mass_kg <= 0.0) continue;
        const double z = state.world_from_object.translation.z();
        const double speed_sq = state.linear_velocity.squaredNorm();
        const double specific = 0.5 * speed_sq + kGravity * std::max(0.0, z);
        const Eigen::Vector3d spin =
            state.world_from_object.rotation.conjugate() * state.angular_velocity;
        energy_j += thing.mass_kg * (0.5 * speed_sq + kGravity * z) +
                    0.5 * spin.dot(thing.inertia.cwiseProduct(spin));
        figures_.rigid_mps = std::max(figures_.rigid_mps, std::sqrt(speed_sq));
        figures_.spin_rad_s = std::max(figures_.spin_rad_s, spin.norm());
        figures_.lowest_m = std::min(figures_.lowest_m, z);
        Whole& whole = wholes_[thing.whole];
        whole.mass_kg += thing.mass_kg;
        whole.energy_j += thing.mass_kg * specific;
        ++whole.num_parts;
        note(-z, -bounds_.lowest_m, thing.name + " below the floor [m]", time_s);
    }
    for (const auto& [id, whole] : wholes_) {
        const double specific = whole.energy_j / whole.mass_kg;
        figures_.rigid_specific = std::max(figures_.rigid_specific, specific / most_specific_);
        note(specific, most_specific_, things_.at(id).name + " [m2/s2]", time_s);
    }
    for (const physics::RigidState& state : rigid_) {
        const Thing& thing = things_.at(state.id);
        if (thing.mass_kg <= 0.0 || wholes_.at(thing.whole).num_parts == 1) continue;
        note(state.linear_velocity.norm(),
             kRounded * bounds_.part_mps,
             thing.name + " [m/s]",
             time_s);
    }
    return energy_j;
}

// All nodes of an object count as equally heavy. Energy in its links does not count.
double WorldWatch::look_at_soft(double time_s) {
    scene_.world().get_soft_states(soft_);
    double energy_j = 0.0;
    for (const physics::SoftState& state : soft_) {
        const Thing& thing = things_.at(state.id);
        double sum = 0.0;
        for (std::size_t i = 0; i < state.positions.size(); ++i) {
            const double z = state.positions[i].z();
            const double speed_sq = state.velocities[i].squaredNorm();
            sum += 0.5 * speed_sq + kGravity * z;
            figures_.soft_mps = std::max(figures_.soft_mps, std::sqrt(speed_sq));
            figures_.lowest_m = std::min(figures_.lowest_m, z);
            note(std::sqrt(speed_sq),
                 kRounded * bounds_.part_mps,
                 "a node of " + thing.name + " [m/s]",
                 time_s);
            note(-z, -bounds_.lowest_m, "a node of " + thing.name + " below the floor [m]", time_s);
        }
        const double specific = sum / static_cast<double>(state.positions.size());
        figures_.soft_specific = std::max(figures_.soft_specific, specific / most_specific_);
        note(specific, most_specific_, thing.name + " [m2/s2]", time_s);
        energy_j += thing.mass_kg * specific;
    }
    return energy_j;
}

void WorldWatch::look(double time_s) {
    const double energy_j = look_at_rigid(time_s) + look_at_soft(time_s);
    figures_.energy_j = std::max(figures_.energy_j, energy_j);
    note(energy_j, figures_.energy_bound_j, "energy of all [J]", time_s);

    scene_.world().take_incidents(incidents_);
    for (const physics::Incident& incident : incidents_) {
        figures_.incidents.push_back(incident);
        if (incident.kind == physics::IncidentKind::kLeft || !figures_.broken.empty()) continue;
        figures_.broken = fmt::format("{} {}, after {:.2f} s",
                                      things_.at(incident.object).name,
                                      physics::describe(incident.kind),
                                      time_s);
    }

    const std::uint64_t contact_ticks = scene_.world().counters().num_contact_ticks;
    const bool is_touched = contact_ticks != contact_ticks_ || !incidents_.empty();
    if (!is_touched && !was_touched_ && energy_before_j_ < kUnknown) {
        ++figures_.num_untouched;
        const double gain_j = energy_j - energy_before_j_;
        figures_.untouched_gain_j = std::max(figures_.untouched_gain_j, gain_j);
        if (bounds_.untouched_gain_j > 0.0)
            note(gain_j, bounds_.untouched_gain_j, "energy from nowhere in a tick [J]", time_s);
    }
    contact_ticks_ = contact_ticks;
    was_touched_ = is_touched;
    energy_before_j_ = energy_j;
}

}  // namespace atrium::test
