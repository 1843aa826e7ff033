#pragma once

#include "simulation/motion_parts.hpp"

/// Motions of people who play with the things of a world, for loops of some 3 s. Distances are of
/// the body frame (skeleton.hpp), of a person of kNominalHeight.
namespace atrium::simulation {

/// The right foot swings 0.11 m to the right of the middle; its tip is 0.25 m ahead, 0.1 m high and
/// at its fastest when it meets a ball that touches the toes.
BodyPose kick(const Phase& phase);

/// The right hand, its edge down, 1.15 m high and 0.12 m to the right, goes forwards until the
/// fingertips are 0.75 m ahead.
BodyPose nudge(const Phase& phase);

/// Both hands dip to 0.15 m above the floor, half a metre ahead, and fly up to 1.4 m.
BodyPose scoop(const Phase& phase);

/// Three steps of each foot within 0.3 m ahead, the feet 0.25 m high in between.
BodyPose wade(const Phase& phase);

/// Both hands meet 0.6 m ahead at 1.25 m, go a metre apart, and the body steps forwards by 0.5 m
/// between them; then all goes back.
BodyPose part(const Phase& phase);

/// Both forearms, 0.11 m to either side and palms up, rise from 0.92 m to 1.2 m some 0.4 m ahead,
/// go 0.1 m to the left and back, and down again.
BodyPose carry(const Phase& phase);

}  // namespace atrium::simulation
