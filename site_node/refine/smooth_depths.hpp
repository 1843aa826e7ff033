#pragma once

#include "core/image/colour_rows.hpp"
#include "site_node/refine/surfels.hpp"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace atrium::refine {

/// Weights of the terms of smooth depths. Those of the depths themselves are at most 1.1.
struct SmoothDepthsOptions {
    float smoothness = 1.0F;     // differences between neighbours
    float hull_weight = 0.005F;  // the hull itself, where nothing is known
    float held_weight = 10.0F;   // the hull, where the person touches it
    float outlier_m = 0.012F;    // a found or earlier depth this far off counts a quarter
};

/// Smooth depths of surfels below the hull: they minimise the weighted squares of the differences
/// to found depths, to those of the metaframe before, to the hull, and between neighbours. Keeps
/// its memory.
class SmoothDepths {
public:
    /// What is known of each surfel.
    std::vector<float> found_m;
    std::vector<float> weights;          // of `found_m`; 0: nothing was found
    std::vector<std::uint8_t> is_held;   // on the hull
    std::vector<float> earlier_m;        // the depth in the metaframe before
    std::vector<float> earlier_weights;  // 0: there is none
    std::vector<float> depths_m;         // the solution; `solve` goes on from it

    /// Starts with nothing known of these surfels, and depths of 0.
    void assign(const Surfels& surfels);

    /// Goes through all surfels `num_rounds` times (Gauss-Seidel). Weights of found depths fall
    /// with the difference that is left. What counts as far off falls from `first_outlier_m` to
    /// that of the options, by `kNarrowing` per round, so that at first the many decide what is an
    /// outlier. Weights of earlier depths fall likewise, but with the limit of the options from the
    /// start: where the surface jumps, what is found now wins. All instruction sets give the same
    /// bits.
    void solve(const SmoothDepthsOptions& options,
               int num_rounds,
               float first_outlier_m,
               image::RowCode code = image::best_row_code());

    /// Factor per round.
    static constexpr float kNarrowing = 0.7F;

private:
    std::vector<float> most_m_;
    // Neighbours in rows of whole vectors. Their weights have the sum 1, or 0 without neighbours;
    // those that fill a row up have the weight 0.
    std::vector<std::uint32_t> begins_;
    std::vector<std::uint32_t> neighbours_;
    std::vector<float> shares_;
};

}  // namespace atrium::refine
