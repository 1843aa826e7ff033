#pragma once

#include "tests/support/shapes/silhouette_maker.hpp"
#include "tests/support/shapes/union_outline.hpp"

#include <Eigen/Core>

#include <cstdint>
#include <random>
#include <span>
#include <string>
#include <vector>

namespace atrium::test {

/// The convex hull of some points and balls: a box, a ball, a rod, a limb (round cone).
struct ConvexPart {
    std::vector<Eigen::Vector3d> corners_site;
    std::vector<Sphere> balls;
};

/// The bodies of a scene: the union of convex parts, all within `radius_m` of `centre_site`.
struct Bodies {
    std::vector<ConvexPart> parts;
    Eigen::Vector3d centre_site{0.0, 0.0, 0.9};
    double radius_m = 1.2;
};

/// A person of 14 limbs in a random pose. Sometimes a hand rests on the hip, which leaves a hole
/// between arm and body.
std::vector<ConvexPart> make_person(std::mt19937_64& random, const Eigen::Vector3d& floor_site);

enum class BodyKind : std::uint8_t { kPeople, kBalls, kBoxes, kRods, kMixed };
Bodies make_bodies(BodyKind kind, std::mt19937_64& random);

enum class RigKind : std::uint8_t {
    kRing,             // around the bodies
    kAnywhere,         // on a sphere around them, also from above and below
    kCollinear,        // all centres on one line
    kOpposite,         // in pairs that look at each other through the bodies
    kCoplanar,         // all centres in the plane of the boxes' upper faces, some axes along edges
    kBehindEachOther,  // pairs on one axis
    kSharedCentre,     // one pair at the same place, with different rotations
};
std::vector<geometry::CalibratedCamera> make_scene_rig(RigKind kind,
                                                       int num_views,
                                                       const Bodies& bodies,
                                                       std::mt19937_64& random);

struct SceneOptions {
    BodyKind bodies = BodyKind::kPeople;
    RigKind rig = RigKind::kRing;
    int num_views = 8;
    int segments_per_view = 100;
    double noise_px = 0.0;  // of every contour point, the same in x and y
    double shift_px = 0.0;  // of every silhouette as a whole, like a bad calibration
    bool cropped = false;   // silhouettes end at the borders of small pictures
};

/// Random options that cover realistic and unrealistic input: mostly 3 to 8 views with 20 to 150
/// segments, up to 16 views and 600 segments.
SceneOptions random_scene_options(std::uint64_t seed);

/// Silhouettes of `bodies` in all views of `rig`; uses the segments, errors and `cropped` of
/// `options`.
std::vector<hull::SilhouetteView> views_of(const Bodies& bodies,
                                           std::vector<geometry::CalibratedCamera> rig,
                                           const SceneOptions& options,
                                           std::mt19937_64& random);

/// Silhouettes of one set of bodies in all views of a rig, repeatable from `seed`. Without noise
/// and shift they are consistent: the hull contains the bodies, up to the outlines' resolution.
std::vector<hull::SilhouetteView> make_scene(const SceneOptions& options, std::uint64_t seed);

/// A description for failure messages.
std::string describe(const SceneOptions& options, std::uint64_t seed);

}  // namespace atrium::test
