#pragma once

#include "viewer/renderer/person_model.hpp"

#include <Eigen/Core>

#include <array>
#include <cstdint>
#include <vector>

namespace atrium::renderer {

inline constexpr std::size_t kCamerasPerVertex = 3;
/// Triangles are grouped by how many cameras their three corners use together.
inline constexpr std::array<std::size_t, 3> kCamerasPerTriangle = {2, 4, 6};

/// Which cameras colour one vertex, seen from one viewpoint.
struct VertexBlend {
    std::array<std::uint8_t, kCamerasPerVertex> cameras{};
    std::array<float, kCamerasPerVertex> weights{};  // sum 1; less where the last camera fades
                                                     // out, 0 where none sees the vertex
};

/// Triangles that face the viewer, not indexed, as floats:
/// position[3], fallback colour[3], layers[n], then n times (s z, t z, z, weight).
struct BlendGroup {
    std::vector<float> data;
    std::size_t num_vertices = 0;
};
constexpr std::size_t floats_per_vertex(std::size_t num_cameras) { return 6 + 5 * num_cameras; }

struct BlendedMesh {
    std::array<BlendGroup, kCamerasPerTriangle.size()> groups;  // n = kCamerasPerTriangle[i]
};

struct BlendScratch {
    std::vector<VertexBlend> vertices;
    std::vector<std::array<float, kCamerasPerVertex + 1>> penalties;
    std::vector<Eigen::Vector3f> to_eye;  // per vertex, unit
    std::vector<float> cos_eye;           // per vertex: between that and the normal
};

/// Chooses for each vertex the three cameras whose direction is nearest to the viewer's.
///
/// Penalty of a camera: angle between the directions to it and to the eye, over its quality at the
/// vertex, and how much more the surface is foreshortened to it than to the eye. Weight:
/// ((1 - penalty / threshold) / penalty)^2, the threshold being the fourth smallest penalty: it
/// reaches 0 where another camera takes its place, so that nothing pops.
///
/// After: Buehler, Bosse, McMillan, Gortler, Cohen. Unstructured Lumigraph Rendering. SIGGRAPH
/// 2001. We differ: visibility is in the quality, weights are squared, and the blending field is
/// evaluated at the vertices of the surface instead of in the picture plane.
void choose_cameras(const PersonModel& model, const Eigen::Vector3f& eye_site, BlendScratch& out);

/// `choose_cameras`, and lays out the triangles for drawing, each without the cameras to which it
/// is edge-on. At most 255 cameras.
void blend_for_view(const PersonModel& model,
                    const Eigen::Vector3f& eye_site,
                    BlendScratch& scratch,
                    BlendedMesh& out);

}  // namespace atrium::renderer
