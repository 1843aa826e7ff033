#pragma once

#include "viewer/renderer/person/camera_blend.hpp"
#include "viewer/renderer/person/person_model.hpp"

#include <Eigen/Core>

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace atrium::renderer {

inline constexpr std::size_t kStripCameras = 3;

struct OutlineStripOptions {
    float width_texels = 2.0F;  // of the picture of the camera nearest to the eye
    /// A camera whose mask has not ended this far outside does not see the outline there.
    float end_texels = 4.0F;
    /// Nor does one at this cosine to the normal, or more.
    float most_cosine = 0.5F;
    /// The strip lies this far behind the outline: before the room, and behind the rest of the
    /// person.
    float behind_m = 0.1F;
    float part_m = 0.025F;  // length of its parts, at least
};

/// A strip around the outline of a person as one eye sees it.
///
/// A visual hull lies inside the silhouettes of all cameras. Where these disagree, because of
/// calibration or segmentation, the cameras near the eye saw the person a few pixels beyond its
/// outline. The strip shows that, in the colours of the surface at the outline. The masks of the
/// three cameras whose directions are nearest to the eye's decide how opaque it is
/// (outline_strip_fragment), as far as they see an outline there too. At the place of a camera the
/// outline becomes that of its mask.
///
/// The strip begins where the normals of the surface are perpendicular to the view, and follows
/// them outwards. It is left out where it would not be seen at all. Keeps its memory.
class OutlineStrip {
public:
    /// Finds the strip for `eye_site`. `blended` is the outcome of `blend_for_view` for that eye.
    void find(const PersonModel& model,
              const Eigen::Vector3f& eye_site,
              const BlendScratch& blended,
              const OutlineStripOptions& options = {});

    /// Triangles without indices, six vertices for each part of the strip. Each vertex as `lay_out`
    /// writes it for kStripCameras, with weights whose sum is at most 1, and the strip's colour as
    /// the fallback colour.
    std::span<const float> vertices() const { return vertices_; }
    std::size_t num_vertices() const { return vertices_.size() / floats_per_vertex(kStripCameras); }

    /// A place on an edge of the mesh where the normal is perpendicular to the view.
    struct Crossing {
        static constexpr std::uint32_t kNone = ~std::uint32_t{0};
        std::uint32_t from = 0;  // the edge's ends, `from` < `to`
        std::uint32_t to = 0;
        std::array<std::uint32_t, 2> next{kNone, kNone};  // beyond the triangles beside the edge
        bool is_done = false;
    };

private:
    std::uint32_t crossing_of(std::uint32_t a, std::uint32_t b);
    void find_crossings(const PersonModel& model, const float* cos_eye);

    std::vector<std::array<std::uint32_t, 3>> crossed_;  // triangles at the outline
    std::vector<std::uint32_t> slots_;  // hash table of crossings; its size is a power of two
    std::vector<Crossing> crossings_;
    std::vector<float> vertices_;
};

}  // namespace atrium::renderer
