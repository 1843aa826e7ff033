#pragma once

#include "core/bus/messages.hpp"

#include <Eigen/Core>

#include <cstdint>
#include <optional>
#include <random>
#include <string>
#include <vector>

namespace atrium::bench {

/// One push: a hand came to a ball at rest, and the ball began to move.
struct Push {
    // time when the hand's surface met the ball's, between the two meshes around it
    Timestamp touch;
    Timestamp capture;         // of the first mesh with the hand in the ball
    Timestamp mesh_received;   // when this program received that mesh
    Timestamp moved;           // stamp of the first published state in which the ball moves
    Timestamp state_received;  // when this program received that state
};

/// The ball that is put in front of a hand.
struct Target {
    std::string site;
    geometry::RigidTransform world_from_site;
    bus::SceneObject ball;                    // at rest at its place
    Eigen::Vector3d spread_m{0.0, 0.0, 0.0};  // its place varies at random up to this much
};

/// Watches one hand that comes and goes, through the meshes of its site, and puts a ball in front
/// of it whenever it is away. It detects pushes only from messages on the bus: the meshes'
/// triangles and the ball's place. It uses no network and no clock, and one thread.
class PushWatch {
public:
    PushWatch(Target target, std::uint64_t seed);

    /// Each may return a command: put the ball, or take it away.
    std::optional<bus::SceneCommand> see(const bus::SiteMesh& mesh, Timestamp received);
    std::optional<bus::SceneCommand> see(const bus::SceneState& state, Timestamp received);

    const std::string& site() const { return target_.site; }
    const std::vector<Push>& pushes() const { return pushes_; }
    /// Balls that were not pushed before the hand went back, or that were never at rest.
    std::size_t num_missed() const { return num_missed_; }

private:
    enum class Phase { kHandComes, kPut, kArmed, kDone };
    std::optional<bus::SceneCommand> look_for_end();
    bus::SceneCommand put_ball();
    bus::SceneCommand take_ball();

    Target target_;
    std::mt19937_64 random_;
    Phase phase_ = Phase::kDone;
    Eigen::Vector3d place_world_ = Eigen::Vector3d::Zero();  // of the ball, at rest
    int num_still_ = 0;                                      // consecutive states
    std::optional<double> gap_m_;  // of the previous mesh: hand to ball, < 0 inside
    Timestamp gap_capture_;
    Push push_;
    std::vector<Push> pushes_;
    std::size_t num_missed_ = 0;
};

}  // namespace atrium::bench
