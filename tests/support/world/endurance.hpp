#pragma once

#include "tests/support/world/acted_person.hpp"
#include "world_server/scene.hpp"

#include <Eigen/Core>

#include <cstdint>
#include <map>
#include <string>
#include <vector>

/// Two people who move about in a world, and bounds that must hold after every step.
namespace atrium::test {

/// A person who walks, pushes, waves, sways and raises the arms on the spot, repeatedly: a loop of
/// `kWanderLoopS` in the body's own frame.
Act wander_act(const std::string& look);
constexpr double kWanderLoopS = 15.0;

/// Path of this person: a rosette of 1.5 m around the middle of the world, at 0.7 m/s at most.
/// Different `phase_rad` keep several people apart.
geometry::RigidTransform wander_place(double time_s, double phase_rad);

/// Speed of the fastest point of the body in the loop [m/s], with the walk, from 30 pictures a
/// second.
double wander_speed_mps(const Act& act);

/// Limits of a world with people in it. An object that is hit leaves with at most 1.5 times the
/// speed of the hand, because nothing is more elastic on skin, and from at most the height that the
/// hand reaches. From then on only gravity accelerates it. The energy of a whole world is at most
/// that of all objects at their start, or at head height, moving as fast as people. The ends of a
/// cloth and the limbs of a puppet can crack like a whip. As a whole they obey the bounds of any
/// object; single nodes and parts obey only the world's own speed limit. As long as nobody touches
/// anything, only motors and stretched parts add energy.
struct EnduranceBounds {
    double people_mps = 0.0;  // of the fastest limb
    double hit_factor = 1.5;
    double reach_m = 2.1;
    double part_mps = 15.0;  // WorldOptions::max_speed_mps
    double head_m = 1.8;
    double lowest_m = -0.1;         // of the centre of any object: below, it fell through the floor
    double untouched_gain_j = 0.0;  // in one tick, see above; 0: measured, but not bounded
};

/// The worst values observed in a world.
struct EnduranceFigures {
    double rigid_mps = 0.0;
    double spin_rad_s = 0.0;
    double soft_mps = 0.0;  // of any node
    // Largest v^2 / 2 + g z over its bound: of joined objects by their mean over mass, of soft
    // objects by the mean of their nodes.
    double rigid_specific = 0.0;
    double soft_specific = 0.0;
    double energy_j = 0.0;
    double energy_bound_j = 0.0;
    double lowest_m = 1e9;          // of a centre or node
    double untouched_gain_j = 0.0;  // in one tick
    // ticks without contact, with people in this tick and the last
    std::uint64_t num_untouched = 0;
    std::vector<physics::Incident> incidents;  // objects that the world reset
    std::string broken;                        // the first broken bound, with object and time
};

/// Checks a world after each of its ticks.
class WorldWatch {
public:
    /// Gravity is along -z. `joints` hold the scene together. `scene` must outlive this.
    WorldWatch(world_server::Scene& scene,
               const std::vector<physics::Joint>& joints,
               const EnduranceBounds& bounds);

    void look(double time_s);
    /// Call before the world is reset to its start. The next energy gain does not count.
    void forget() { energy_before_j_ = kUnknown; }
    const EnduranceFigures& figures() const { return figures_; }

private:
    static constexpr double kUnknown = 1e300;
    struct Thing {
        std::string name;
        double mass_kg = 0.0;
        Eigen::Vector3d inertia;  // of its bounding box, about its middle
        std::uint32_t whole = 0;  // the same for all objects that are joined and move together
    };
    struct Whole {
        double mass_kg = 0.0;
        double energy_j = 0.0;  // without rotation
        std::size_t num_parts = 0;
    };

    double look_at_rigid(double time_s);
    double look_at_soft(double time_s);
    void join(const physics::Joint& joint);
    void note(double value, double bound, const std::string& what, double time_s);

    world_server::Scene& scene_;
    EnduranceBounds bounds_;
    double most_specific_ = 0.0;  // [m^2/s^2]
    std::map<std::uint32_t, Thing> things_;
    EnduranceFigures figures_;
    std::uint64_t contact_ticks_ = 0;
    bool was_touched_ = true;
    double energy_before_j_ = kUnknown;
    std::vector<physics::RigidState> rigid_;  // scratch, as are the next three
    std::map<std::uint32_t, Whole> wholes_;
    std::vector<physics::SoftState> soft_;
    std::vector<physics::Incident> incidents_;
};

}  // namespace atrium::test
