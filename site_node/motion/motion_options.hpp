#pragma once

namespace atrium::motion {

/// Options of SurfaceMotion. Pixels are those of a quarter of a camera's resolution.
struct SurfaceMotionOptions {
    float cell_m = 0.1F;         // lattice spacing; the surface in each cell moves as one piece
    float sample_m = 0.045F;     // distance of the points at which pictures are compared
    double max_period_s = 0.15;  // longer gaps: nothing is known
    double max_speed_mps = 12.0;

    // which points a camera sees
    float least_facing = 0.25F;  // cosine between normal and direction to the camera
    float hidden_m = 0.04F;      // a point this far behind the nearest surface is hidden
    float same_depth_m = 0.05F;  // pixels at other depths are not part of a point's patch
    int least_pixels = 12;       // of a patch

    // weights
    float noise_sq = 2.0F;    // [grey levels^2] a gradient this strong counts half
    float differs = 8.0F;     // [grey levels] patches that differ by this count a quarter
    float start_px = 2.0F;    // a flow vector this far off counts a quarter; halves each round
    float settled_px = 0.7F;  // likewise for the step that a patch asks for
    float damping = 0.05F;    // pull towards rest, in points
    float turn_m = 0.14F;     // lever at which rotations are damped
    float spread_m = 0.08F;   // standard deviation of a neighbour's weight
    float reach_m = 0.25F;    // beyond, cells do not influence each other
    float let_go_m = 0.03F;   // at this difference a neighbour counts a quarter
    int flow_rounds = 3;      // of solving with the flow
    int patch_rounds = 4;     // of comparing patches and solving
};

}  // namespace atrium::motion
