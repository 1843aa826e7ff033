#pragma once

#include "site_node/refine/luma_picture.hpp"
#include "site_node/refine/outline_bins.hpp"
#include "site_node/refine/surfels.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace atrium::refine {

struct PhantomPartsOptions {
    /// Parts thinner than each of these are judged against all that is thicker, in falling order.
    std::array<float, 2> thin_m = {0.035F, 0.025F};
    float edge_m = 0.015F;          // the edge of a thin part is this near to it
    float beside_m = 0.05F;         // nothing goes that is this near to a part that is needed
    float outline_piece_m = 0.06F;  // an outline is judged in pieces of this size
    float least_clash = 60.0F;      // between the colours of a part that goes [grey levels]
};

/// Finds parts of a visual hull that nobody has: thin ones that grow out of the body where the
/// cones of several limbs meet. No silhouette needs them: behind each piece of their outlines there
/// is a thicker part of the body, which explains it. And what the cameras show of them does not
/// agree.
///
/// After Miller and Hilton, "Safe Hulls" (2007), who ask the same of whole components and of
/// pixels.
///
/// Deterministic. Keeps its memory. Not thread-safe.
class PhantomParts {
public:
    explicit PhantomParts(const PhantomPartsOptions& options = {}) : options_(options) {}

    /// Finds the parts of a hull of `views` that no silhouette needs: surfels, in rising order.
    std::span<const std::uint32_t> find_unneeded(const Surfels& surfels,
                                                 std::span<const PictureView> views);

    /// Of these, those whose colours clash: `clashes` has one value for each, negative if less than
    /// two cameras see it. Their surroundings decide.
    std::span<const std::uint32_t> find_clashing(const Surfels& surfels,
                                                 std::span<const float> clashes);

private:
    void find_thickness(const Surfels& surfels);
    void find_pieces(const Surfels& surfels, std::span<const PictureView> views);
    void mark_needed(float thin_m);

    PhantomPartsOptions options_;
    std::vector<float> thickness_m_;  // per surfel: of the thinnest that is as near as an edge
    std::vector<double> pieces_px_;   // per view
    std::vector<OutlinePoint> on_outlines_;  // surfels, by their pieces of outlines
    std::vector<std::uint8_t> is_needed_;    // per surfel
    std::vector<float> clashes_;             // per surfel; negative: unknown, or not of such a part
    std::vector<std::uint32_t> unneeded_;
    std::vector<std::uint32_t> clashing_;
    NearScratch near_;
};

}  // namespace atrium::refine
