#pragma once

#include <cstdint>

// Tuned constants of the physics of soft objects.
namespace atrium::physics {

struct SoftContactOptions {
    float margin_m = 0.004F;    // contacts are kept up to this gap
    float near_m = 0.02F;       // and up to this one with bodies, if they move apart
    float recovery_mps = 0.6F;  // speed at which penetrations are resolved
    float step_m = 0.01F;       // along the path of a sample that moves further than this in a tick
    int max_steps = 24;
    float from_inside = 0.1F;  // cosine: a surface that faces like the skin came from inside
    // A slower body may fall asleep on a calm soft object. More than it gains by falling for a
    // tick: a body that only soft objects carry falls at the start of each tick and is lifted
    // again.
    float still_mps = 0.1F;
    float lost_m = 0.15F;      // solid scenery lets go of what was pressed this far through it
    float same_normal = 0.9F;  // cosine: of the faces of one direction, the nearest counts
};

/// Of `SoftDepenetration`.
struct SoftDepenetrationOptions {
    // A surface of a person that is closer to the centre of a volume than this, in radii, pushes
    // all of it.
    float keep_off_radii = 0.7F;
    float keep_off_mps = 0.5F;
    float leaving_mps = 0.5F;      // a surface that recedes faster does not push
    float buried_search_m = 0.5F;  // for the surface nearest to a centre inside a person
};

/// Of `SoftVolume`.
struct SoftVolumeOptions {
    float inner_damping_hz = 4.0F;  // damping of motion relative to the whole
    float rebound_mps = 0.1F;       // of a body that pressed it and moves away: from here on
    float rebound_share = 0.15F;    // its forces are this share of what they are otherwise
    float max_volume_step = 0.02F;  // largest relative volume correction per substep
    // Shape matching gets stronger when a node is further from its place in the rest shape:
    // distance at which this begins and its range, both in radii, and the largest share of the way
    // per substep.
    float dent_start = 0.15F;
    float dent_range = 0.35F;
    float dent_share = 0.3F;
};

/// Of the links of cloth and rope.
struct SoftLinkOptions {
    int rope_rounds = 6;  // solver rounds per iteration for a rope: few links, maybe a heavy load
    float loose_stretch = 1.6F;  // relative length at which a link slips out of hands
    // A link stretched beyond this snaps back, at no more than snap_mps: cloth and rope hardly
    // stretch and lose the stored energy.
    float taut_stretch = 1.2F;
    float snap_mps = 4.0F;
    std::uint8_t snap_ticks = 12;  // duration of the snap
    float open = 0.5F;             // square of the relative length below which a link is folded
    float fold_stiffness = 0.3F;
    float damping_hz = 15.0F;  // damping of motion along a link
};

/// Of holding a soft object by a group of its nodes.
struct SoftHandleOptions {
    float hand_m = 0.06F;  // nodes within this distance of the point are held
    float swing_damping_hz = 4.0F;
};

/// Of the soft objects in a `World`.
struct SoftOptions {
    double substep_s = 1.0 / 480.0;
    int max_substeps = 16;  // per tick
    // A volume, or those nodes of a cloth, under a body that has more than so many times their mass
    // need shorter substeps, by the square root of what is beyond.
    float heavy_load = 4.0F;
    int num_iterations = 2;  // solver iterations per substep
    // Nodes further apart than about two fingers let fingers through. Then face centres are
    // samples too.
    float fingers_m = 0.025F;
    float calm_mps = 0.02F;  // below this mean speed, an object comes to rest
    float calm_damping_hz = 4.0F;
    float torn_extents = 2.5F;  // relative size above which the state is not plausible
    SoftContactOptions contacts{};
    SoftDepenetrationOptions depenetration{};
    SoftVolumeOptions volume{};
    SoftLinkOptions links{};
    SoftHandleOptions handle{};
};

}  // namespace atrium::physics
