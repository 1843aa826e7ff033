#pragma once

#include "world_server/physics/options/rigid_options.hpp"

#include <cstddef>
#include <cstdint>

// Tuned constants of the physics of people. Rest: no motion. A motion explains a point that it puts
// onto the other mesh. A leap: a start far from every expected motion.
namespace atrium::physics {

/// Of `SurfaceIndex`.
struct SamplingOptions {
    double spacing_m = 0.02;         // one sample per square of this side length
    std::size_t max_samples = 6000;  // per mesh; larger surfaces are sampled more sparsely
    double min_cell_m = 0.04;        // about two sample spacings: a handful of samples per cell
    float smooth_m = 0.03F;          // radius around a sample over which its normal is averaged
};

/// Of matching a place with the previous surface.
struct MotionMatchOptions {
    float same_facing = 0.6F;    // cosine
    float search_m = 0.05F;      // search radius around the displaced point
    float explained_m = 0.012F;  // rest explains a point closer than this along the normal
    float scale_m = 0.012F;      // distance that costs half of a mismatch
};

/// Of the start values for a region's motion.
struct MotionStartOptions {
    std::size_t trial_points = 24;  // points of a region on which a start is tried
    float slides_m = 0.004F;        // smaller predictions are not worth a start
    float no_worse = 0.05F;         // cost by which the previous motion may fit worse than rest
    float hard_cost = 0.08F;        // above this, a region is not explained
    float agreement = 0.15F;        // cost of disagreeing with all neighbours
    // A region of this many points pays twice what a large one pays for a leap or disagreement.
    float few_points = 15.0F;
    // Cost of a motion that differs by surprise_m from the expected one; the same again for each
    // additional further_m.
    float surprise = 0.13F;
    float surprise_m = 0.1F;
    float further_m = 0.2F;
    float previous_m = 0.15F;      // a place further than this from its prediction is another one
    float bin_m = 0.04F;           // bin size of the votes
    std::size_t max_voters = 200;  // points of a group that vote
};

/// Of solving for the motion of all regions.
struct MotionSolveOptions {
    int num_rounds = 3;         // of matching and solving
    int max_sweeps = 30;        // Gauss-Seidel sweeps
    float least = 0.05F;        // weight of a point that fits badly; it still pulls a little
    float damping = 0.02F;      // pull towards the start, in points per point
    float hold = 0.002F;        // like damping in the joint solution, where neighbours stabilise
    float pull = 0.05F;         // towards the previous motion, in points per point
    float coupling = 0.1F;      // in points per pair of adjacent points
    float let_go_m = 0.02F;     // at this difference, couplings and the pull have lost a good part
    float turn_m = 0.07F;       // a region's radius: converts rotations to displacements
    float turn_alike = 1.0F;    // weight of a coupling on the rotations themselves
    float max_turn = 0.5F;      // [rad]
    float same_place_m = 0.1F;  // between a region's predicted place and a region of the next mesh
    // A region that moves by less than settled_m does not notify its neighbours; below
    // same_matches_m it keeps its matches. Rotations count at the region's radius.
    float settled_m = 3e-5F;
    float same_matches_m = 3e-4F;
};

/// Of the motion of a surface between two meshes, found by `MotionEstimator`.
struct MotionOptions {
    double region_m = 0.14;         // lattice spacing; each cell moves as one region
    std::size_t max_points = 2000;  // matched points per mesh
    double max_step_m = 0.5;        // largest displacement between two meshes
    float moving_share = 0.12F;     // share of an octant's points that rest does not explain
    float touch_m = 0.06F;          // distance between points of neighbouring regions
    float near_m = 0.1F;            // distance of neighbours with the most weight
    float alike_m = 0.05F;          // largest difference between parts that move together
    float mismatch = 0.6F;          // cost above which a sample does not belong to its region
    // Below this difference between adjacent motions, it does not matter to which region a sample
    // belongs.
    float indifferent_m = 0.01F;
    MotionMatchOptions match{};
    MotionStartOptions start{};
    MotionSolveOptions solve{};
};

/// Of `PersonShaper`.
struct PersonShapeOptions {
    SamplingOptions sampling{};
    MotionOptions motion{};
    double max_speed_mps = 10.0;   // limit; faster surfaces are slowed to this
    double rest_speed_mps = 0.06;  // slower motion counts as flicker of the outline
    double max_period_s = 0.15;    // longer gaps: the next mesh is treated as a new person
    // Search for the previous surface, onto which the start of a surfel is put.
    float same_facing = 0.5F;  // cosine: normals at most 60 degrees apart
    float search_m = 0.05F;    // around the place given by the motion
    float max_off_m = 0.03F;   // largest correction of a surfel
};

/// Of `PersonField`.
struct PeopleFieldOptions {
    float cell_m = 0.04F;     // about two surfel spacings: a handful per cell
    float reach_m = 0.04F;    // largest distance at which a surface is found; at most cell_m
    float facing = -0.25F;    // cosine of the normals of a person and an object that may touch
    float beside_m = 0.022F;  // extent of a surfel's surface: 2 cm apart on average, with gaps
    // Weight of squared distance along a surface, relative to distance along its normal, in the
    // choice of the surface. Distances along the surface thus count half. Near an edge, sparse
    // samples would otherwise favour the wrong side.
    float beside_weight = 0.25F;
    float leaving_mps = 0.5F;  // a point that leaves faster is not touched
    float entered_m = 0.005F;  // a point less deep than this one tick ago entered through this side
    float smooth_m = 0.035F;   // support radius of the plane around the foot point
    float same_facing = 0.7F;  // cosine, of surfels that support the plane
    int min_support = 2;       // a single surfel is an error of the motion estimate
};

/// Of `ContactFinder`.
struct ContactSearchOptions {
    float touch_m = 0.004F;  // largest gap of a contact
    float fast_m = 0.015F;   // relative motion per tick above which paths are followed
    float disc_m = 0.02F;    // radius of a surfel's disc
    // Cosines between a sphere's sample and the person's normal. Below the first, the sphere
    // touches the plane at the sample. Up to the second, the sample may have passed an edge.
    float facing_plane = -0.8F;
    float facing_edge = -0.3F;
    float same_side = 0.3F;         // cosine: a contact whose normal is closer than this to an edge
                                    // contact's replaces it
    float same_normal = 0.9F;       // cosine: near contacts count once
    float min_apart_m = 0.012F;     // of contacts with the same normal
    float turning_m = 0.01F;        // smaller extents hardly determine a rotation
    std::size_t max_contacts = 12;  // per object and person
};

/// Of `GripCorrection`.
struct GripOptions {
    float stick_mps = 0.25F;       // largest mean sliding speed of a contact that sticks
    float stick_radps = 2.0F;      // a ball that rolls along an arm does not stick
    std::size_t loose_ticks = 10;  // ticks without sticking after which the surface is forgotten
    float around_m = 0.10F;        // around contacts the surface is remembered: a hand's length
    std::size_t min_kept = 24;     // samples; fewer do not determine a pose
    std::size_t max_kept = 250;
    int num_rounds = 3;        // of matching and solving
    float search_m = 0.025F;   // for the sample that matches a remembered one
    float same_facing = 0.6F;  // cosine
    float scale_m = 0.008F;    // a point this far off counts half
    float min_share = 0.5F;    // smallest share of points that fit
    float damping = 0.02F;     // per point: keeps undetermined directions unchanged
    float lever_m = 0.1F;      // converts rotations to distances
    float slipped_m = 0.03F;   // an object that lags further has slipped
    float slipped_rad = 0.3F;
    float catch_up_s = 0.1F;  // time in which the lag is removed
    float max_mps = 0.2F;     // of the correction
    float max_radps = 1.5F;
};

/// Of `PeopleContacts`.
struct PeopleContactOptions {
    /// Combined friction: geometric mean of this and the object's friction.
    double friction = 2.0;
    /// Combined restitution: the larger of this and half of the object's restitution. Skin damps.
    double restitution = 0.2;
    double escape_mps = 1.5;   // speed at which an object inside a person is moved out
    float contact_m = 0.005F;  // gap up to which a person counts as touching an object
    float around_m = 0.002F;   // depth of a surface in an object; less is a touch

    // Contacts act like damped springs, because a hand yields around what it holds. The damping
    // lets an overlap relax slowly. Otherwise an object on a hand would be thrown into the air
    // whenever the hull is slightly larger than the previous one. Between two palms the springs
    // settle in the middle, where contradicting velocities would fight. Per mass of the object,
    // shared by its contacts.
    float stiffness = 6400.0F;  // [1/s^2]
    float damping = 600.0F;     // [1/s]
    // Depth reported to Bullet, below its threshold for shifting bodies
    // (`WorldOptions::plain_contact_m`). The contact's error reduction sets the effect of the real
    // depth.
    float reported_depth_m = 0.001F;
    // Closing speed of a hit. Bullet would close the gap in this tick and, depending on its width,
    // have little or no speed left for the bounce in the next. Bullet therefore gets a gap of zero.
    float hit_mps = 0.7F;
    // Rolling resistance on skin and cloth, as a lever in radii of the object: the slope on which a
    // ball stays. A hand yields and cups what it holds, which no hull shows.
    float rolling_lever = 1.5F;
    float spinning_lever = 0.3F;
    std::size_t num_rolling = 3;  // contacts per object that resist rolling

    float deep_radii = 0.6F;       // depth from which an object may be inside a person altogether
    float escape_search_m = 0.5F;  // for the surface nearest to an object inside a person
    std::uint64_t ticks_per_check = 8;  // interval of that test within a person's bounds

    ContactSearchOptions search{};
    GripOptions grip{};
    BodySamplingOptions sampling{};
};

/// Of the people in a `World`.
struct PeopleOptions {
    PeopleFieldOptions field{};
    PeopleContactOptions contacts{};
};

}  // namespace atrium::physics
