#pragma once

#include <cstddef>

// Tuned constants of the physics of rigid objects.
namespace atrium::physics {

/// Of the points on a body's surface that are tested for contacts with people.
struct BodySamplingOptions {
    double spacing_m = 0.025;
    std::size_t max_samples = 3000;  // larger surfaces are sampled more sparsely
    float min_facing = 0.5F;         // cosine; steeper surfaces are sampled from another side
    std::size_t num_tips = 42;       // directions in which extreme points are added
    float same_point_m = 0.004F;     // a tip closer than this to a sample adds nothing
    float sphere_spacing_m = 0.02F;
    std::size_t min_sphere_samples = 26;
    std::size_t max_sphere_samples = 600;
};

/// Bullet adds its margin around a hull and rounds the edges by it. The hull is shrunk by the same
/// amount: the smaller of `margin_m` and `margin_per_radius` times the inner radius.
struct HullOptions {
    double margin_m = 0.004;
    double margin_per_radius = 0.2;  // of the inner radius
};

struct JointOptions {
    int num_iterations = 40;  // a chain of a dozen bodies needs more than contacts do, at low cost
    // A heap of jointed bodies on the floor twitches: a puppet's foot now and then turns at
    // 2 rad/s, which would keep everything awake.
    float sleep_mps = 0.2F;
    float sleep_rad_s = 3.0F;
};

/// Of solver iterations where something light carries something heavy (`LoadSolver`).
struct LoadOptions {
    // Per ratio of the masses. With 1, a tower of 45, 0.7 and 72 kg stands but slides by 6 mm; 2.5
    // keeps such towers within 4 mm.
    float iterations_per_load = 2.5F;
    int max_iterations = 500;  // 20 us per tick for a tower of three boxes at 200
};

/// Of what lies flat on something flat (`FlatContacts`, `MeshContacts`).
struct FlatContactOptions {
    float max_tilt = 0.03F;         // sine; a cylinder that leans more has one point of contact
    float deeper_m = 0.00005F;      // a point deeper by this replaces the lowest of the four
    float hull_search_tilt = 0.1F;  // tangent; the corners of a hull's face are sought so
    float hull_uneven_m = 0.0002F;  // a hull's face with corners further off its plane is not flat
    // Triangles of a mesh whose normals differ by less than 0.8 degrees and whose planes differ by
    // less than 0.1 mm at the thing's foot are one plane.
    float same_plane_turn = 0.0001F;  // one minus the cosine
    float same_plane_m = 0.0001F;
    float min_width_m = 0.001F;      // of the area on a mesh; a narrower one is an edge
    float min_triangle_m2 = 1e-10F;  // twice the area; a smaller one has no certain normal
};

/// Of the rigid objects in a `World`.
struct RigidOptions {
    HullOptions hull{};
    JointOptions joint{};
    LoadOptions load{};
    FlatContactOptions flat{};
    // A body below both for two seconds falls asleep. With Bullet's 0.8 m/s a box that begins to
    // slide down a slope would stop there.
    float sleep_mps = 0.1F;
    float sleep_rad_s = 1.0F;
};

}  // namespace atrium::physics
