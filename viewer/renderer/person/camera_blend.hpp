#pragma once

#include "viewer/renderer/person/person_model.hpp"
#include "viewer/renderer/person/person_rows.hpp"

#include <Eigen/Core>

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace atrium::renderer {

inline constexpr std::size_t kCamerasPerVertex = 3;
/// Groups of triangles, by the number of cameras that their three corners use together.
inline constexpr std::array<std::size_t, 5> kCamerasPerTriangle = {1, 2, 3, 4, 6};

/// The cameras that colour one vertex, seen from one viewpoint.
struct VertexBlend {
    std::array<std::uint8_t, kCamerasPerVertex> cameras{};
    /// Sum is 1, less where the last camera fades out, 0 where no camera sees the vertex.
    std::array<float, kCamerasPerVertex> weights{};
};

/// Contribution of one camera to the colours of one triangle.
struct BlendSlot {
    std::array<float, 3> weights{};  // at the corners
    std::uint8_t camera = 0;
};

/// Triangles that face the viewer and use up to n cameras.
struct BlendGroup {
    std::vector<std::uint32_t> triangles;
    std::vector<BlendSlot> slots;  // n per triangle; unused slots have camera 0 and weight 0.
    std::size_t num_vertices() const { return 3 * triangles.size(); }
};

struct BlendedMesh {
    std::array<BlendGroup, kCamerasPerTriangle.size()> groups;  // n = kCamerasPerTriangle[i]
};

struct BlendScratch {
    std::vector<VertexBlend> vertices;
    Axes points;
    Axes normals;
    Axes to_eye;                 // per vertex, length 1
    std::vector<float> cos_eye;  // per vertex: cosine between `to_eye` and the normal
    std::array<std::vector<float>, kCamerasPerVertex + 1> penalties;  // ascending
    /// Cameras of the smallest penalties.
    std::array<std::vector<std::int32_t>, kCamerasPerVertex> candidates;
    std::array<std::vector<float>, kCamerasPerVertex> weights;
};

/// Chooses for each vertex the three cameras whose direction is closest to the viewer's.
///
/// Penalty of a camera: angle between the directions to the camera and to the eye, divided by the
/// camera's quality at the vertex, plus a term for a surface that the camera sees more
/// foreshortened than the eye does. Weight: ((1 - penalty / threshold) / penalty)^2, where the
/// threshold is the fourth smallest penalty. The weight reaches 0 where another camera takes over,
/// which prevents popping. A share below one twentieth fades out and goes to the other cameras: it
/// is invisible, and most triangles then need two cameras less.
///
/// After: Buehler, Bosse, McMillan, Gortler, Cohen. Unstructured Lumigraph Rendering. SIGGRAPH
/// 2001. Differences: visibility is part of the quality, weights are squared, and the blending
/// field is evaluated at the vertices instead of in the picture plane.
/// All instruction sets give the same bits.
void choose_cameras(const PersonModel& model,
                    const Eigen::Vector3f& eye_site,
                    BlendScratch& out,
                    image::RowCode code = image::best_row_code());

/// Runs `choose_cameras` and groups the triangles by the number of their cameras. Drops cameras
/// that see a triangle edge-on. At most 255 cameras.
void blend_for_view(const PersonModel& model,
                    const Eigen::Vector3f& eye_site,
                    BlendScratch& scratch,
                    BlendedMesh& out);

/// Like `blend_for_view`, of all triangles, for a texture that is seen from everywhere: each point
/// has an eye of its own, far away on its normal.
void blend_for_texture(const PersonModel& model, BlendScratch& scratch, BlendedMesh& out);

/// Weight of the fallback colour beside those of the cameras, whose sum is at most 1.
inline constexpr float kFallbackWeight = 0.01f;

/// Floats per vertex: position[3], fallback colour[3], layers[n], then n times (s z, t z, z,
/// weight).
constexpr std::size_t floats_per_vertex(std::size_t num_cameras) { return 6 + 5 * num_cameras; }

/// Writes the three vertices of each triangle of group `group`, without indices. `out` has room for
/// num_vertices() vertices.
void lay_out(const PersonModel& model,
             const BlendedMesh& blended,
             std::size_t group,
             std::span<float> out);

}  // namespace atrium::renderer
