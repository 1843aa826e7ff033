#pragma once

#include "tests/support/acted_person.hpp"
#include "world_server/scene.hpp"

#include <Eigen/Core>

#include <cstdint>
#include <map>
#include <string>
#include <vector>

/// Two people who move about in a world, and what must hold of it after every step.
namespace atrium::test {

/// Somebody who walks, pushes, waves, sways and raises the arms on the spot, again and again: a
/// loop of `kWanderLoopS` in the body's own frame.
Act wander_act(const std::string& look);
constexpr double kWanderLoopS = 15.0;

/// Where such a person walks: a rosette of 1.5 m around the world's middle, at 0.7 m/s at most.
/// `phase_rad` keeps several apart.
geometry::RigidTransform wander_place(double time_s, double phase_rad);

/// The fastest place of the body [m/s] in the loop, with the walk; of 30 pictures a second.
double wander_speed_mps(const Act& act);

/// What a world with people in it may do. What is hit leaves with at most 1.5 times the speed of
/// the hand, as nothing is more elastic on skin, from as high as that reaches; from there on only
/// gravity makes it faster. All of a world together has no more energy than if it were where it
/// started, or as high as a head, and as fast as people are. The ends of a cloth and the limbs of a
/// puppet crack like a whip: all of it together is bounded like any other thing, single nodes and
/// parts by the world's own limit of speed only. Where nobody touches anything, nothing but motors
/// and what is stretched adds energy.
struct EnduranceBounds {
    double people_mps = 0.0;  // of the fastest limb
    double hit_factor = 1.5;
    double reach_m = 2.1;
    double part_mps = 15.0;  // WorldOptions::max_speed_mps
    double head_m = 1.8;
    double lowest_m = -0.1;         // of anything's centre: below, it went through the floor
    double untouched_gain_j = 0.0;  // in one tick, see above; 0: looked at, but not bounded
};

/// The worst that was seen of a world.
struct EnduranceFigures {
    double rigid_mps = 0.0;
    double spin_rad_s = 0.0;
    double soft_mps = 0.0;        // of any node
    double rigid_specific = 0.0;  // highest of v^2 / 2 + g z over its bound: what is joined, on the
    double soft_specific = 0.0;   // mean of its mass; soft things, on the mean of their nodes
    double energy_j = 0.0;
    double energy_bound_j = 0.0;
    double lowest_m = 1e9;            // of a centre or node
    double untouched_gain_j = 0.0;    // in one tick
    std::uint64_t num_untouched = 0;  // ticks without a contact with people in them and the last
    std::vector<physics::Incident> incidents;  // what the world put back
    std::string broken;                        // the first bound that was, by what, and when
};

/// Looks at a world after each of its ticks.
class WorldWatch {
public:
    /// Gravity is along -z. `joints` are those that hold the scene together. `scene` must outlive
    /// this.
    WorldWatch(world_server::Scene& scene,
               const std::vector<physics::Joint>& joints,
               const EnduranceBounds& bounds);

    void look(double time_s);
    /// Before the world is put back to its start: what it then gains is not its own doing.
    void forget() { energy_before_j_ = kUnknown; }
    const EnduranceFigures& figures() const { return figures_; }

private:
    static constexpr double kUnknown = 1e300;
    struct Thing {
        std::string name;
        double mass_kg = 0.0;
        Eigen::Vector3d inertia;  // of its bounding box, about its middle
        std::uint32_t whole = 0;  // what it is joined to and moves with has the same
    };
    struct Whole {
        double mass_kg = 0.0;
        double energy_j = 0.0;  // without turning
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
