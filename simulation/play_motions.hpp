#pragma once

#include "simulation/motion_parts.hpp"

/// Motions of people who play with the objects of a world, for loops of some 3 s. Distances are in
/// the body frame (skeleton.hpp), for a person of kNominalHeight.
namespace atrium::simulation {

/// Swings the right foot, 0.11 m right of the middle. At its fastest, its tip is 0.25 m ahead and
/// 0.1 m high, where it meets a ball that touches the toes.
BodyPose kick(const Phase& phase);

/// Moves the right hand, edge down, 1.15 m high and 0.12 m to the right, forwards until the
/// fingertips are 0.75 m ahead.
BodyPose nudge(const Phase& phase);

/// Dips both hands to 0.15 m above the floor, half a metre ahead, and flings them up to 1.4 m.
BodyPose scoop(const Phase& phase);

/// Takes three steps with each foot within 0.3 m ahead, lifting the feet 0.25 m.
BodyPose wade(const Phase& phase);

/// Joins both hands 0.6 m ahead at a height of 1.25 m, parts them by a metre, and steps forwards by
/// 0.5 m between them; then reverses.
BodyPose part(const Phase& phase);

/// Lifts both forearms, 0.11 m to either side with palms up, from 0.92 m to 1.2 m about 0.4 m
/// ahead, moves them 0.1 m to the left and back, and lowers them.
BodyPose carry(const Phase& phase);

}  // namespace atrium::simulation
