#pragma once

#include "core/bus/messages.hpp"

#include <Eigen/Core>

#include <cstdint>
#include <optional>
#include <random>
#include <string>
#include <vector>

namespace atrium::bench {

/// One push: a hand that came to a ball at rest, and the ball that began to move.
struct Push {
    Timestamp touch;           // the hand's surface met the ball's, between the two meshes there
    Timestamp capture;         // of the first mesh in which the hand is in the ball
    Timestamp mesh_received;   // that mesh, by us
    Timestamp moved;           // stamp of the first published state in which the ball moves
    Timestamp state_received;  // that state, by us
};

/// What is put before a hand.
struct Target {
    std::string site;
    geometry::RigidTransform world_from_site;
    bus::SceneObject ball;                    // at rest where it is put
    Eigen::Vector3d spread_m{0.0, 0.0, 0.0};  // it is put up to so far from there, at random
};

/// Watches one hand that comes and goes, by the meshes of its site, and puts a ball before it each
/// time that it is away. What counts as a push is found from what is on the bus alone: from the
/// meshes' triangles and the ball's place. No network and no clock of its own; one thread.
class PushWatch {
public:
    PushWatch(Target target, std::uint64_t seed);

    /// Each may ask for a command: to put the ball, or to take it away.
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
    int num_still_ = 0;                                      // states in a row
    std::optional<double> gap_m_;  // of the mesh before: hand to ball, < 0 inside
    Timestamp gap_capture_;
    Push push_;
    std::vector<Push> pushes_;
    std::size_t num_missed_ = 0;
};

}  // namespace atrium::bench
