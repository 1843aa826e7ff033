#pragma once

#include "viewer/renderer/person_model.hpp"
#include "viewer/renderer/person_rows.hpp"

#include <Eigen/Core>

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace atrium::renderer {

inline constexpr std::size_t kCamerasPerVertex = 3;
/// Triangles are grouped by how many cameras their three corners use together.
inline constexpr std::array<std::size_t, 5> kCamerasPerTriangle = {1, 2, 3, 4, 6};

/// Which cameras colour one vertex, seen from one viewpoint.
struct VertexBlend {
    std::array<std::uint8_t, kCamerasPerVertex> cameras{};
    std::array<float, kCamerasPerVertex> weights{};  // sum 1; less where the last camera fades
                                                     // out, 0 where none sees the vertex
};

/// The part of one camera in the colours of one triangle.
struct BlendSlot {
    std::array<float, 3> weights{};  // at the corners
    std::uint8_t camera = 0;
};

/// Triangles that face the viewer and that up to n cameras colour.
struct BlendGroup {
    std::vector<std::uint32_t> triangles;
    std::vector<BlendSlot> slots;  // n per triangle; of camera 0 and without weight where it has
                                   // fewer
    std::size_t num_vertices() const { return 3 * triangles.size(); }
};

struct BlendedMesh {
    std::array<BlendGroup, kCamerasPerTriangle.size()> groups;  // n = kCamerasPerTriangle[i]
};

struct BlendScratch {
    std::vector<VertexBlend> vertices;
    Axes points;
    Axes normals;
    Axes to_eye;                 // per vertex, unit
    std::vector<float> cos_eye;  // per vertex: between that and the normal
    std::array<std::vector<float>, kCamerasPerVertex + 1> penalties;      // rising
    std::array<std::vector<std::int32_t>, kCamerasPerVertex> candidates;  // of the first ones
    std::array<std::vector<float>, kCamerasPerVertex> weights;
};

/// Chooses for each vertex the three cameras whose direction is nearest to the viewer's.
///
/// Penalty of a camera: angle between the directions to it and to the eye, over its quality at the
/// vertex, and how much more the surface is foreshortened to it than to the eye. Weight:
/// ((1 - penalty / threshold) / penalty)^2, the threshold being the fourth smallest penalty: it
/// reaches 0 where another camera takes its place, so that nothing pops. A share of less than a
/// twentieth is left to the others, fading out as well: nobody sees it, and most triangles need two
/// cameras less.
///
/// After: Buehler, Bosse, McMillan, Gortler, Cohen. Unstructured Lumigraph Rendering. SIGGRAPH
/// 2001. We differ: visibility is in the quality, weights are squared, and the blending field is
/// evaluated at the vertices of the surface instead of in the picture plane.
/// All sets of instructions give the same bits.
void choose_cameras(const PersonModel& model,
                    const Eigen::Vector3f& eye_site,
                    BlendScratch& out,
                    image::RowCode code = image::best_row_code());

/// `choose_cameras`, and sorts the triangles by how many cameras they are drawn with, each without
/// the cameras to which it is edge-on. At most 255 cameras.
void blend_for_view(const PersonModel& model,
                    const Eigen::Vector3f& eye_site,
                    BlendScratch& scratch,
                    BlendedMesh& out);

/// A vertex as floats: position[3], fallback colour[3], layers[n], then n times (s z, t z, z,
/// weight).
constexpr std::size_t floats_per_vertex(std::size_t num_cameras) { return 6 + 5 * num_cameras; }

/// Writes the three vertices of each triangle of group `group`, not indexed. `out` holds
/// num_vertices() of them.
void lay_out(const PersonModel& model,
             const BlendedMesh& blended,
             std::size_t group,
             std::span<float> out);

}  // namespace atrium::renderer
