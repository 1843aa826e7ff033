#pragma once

#include "tools/export/atlas/textured_mesh.hpp"
#include "viewer/renderer/person/person_model.hpp"

#include <cstddef>
#include <optional>

namespace atrium::exporting {

/// Longest side of a texture that programs commonly read.
inline constexpr int kMaxTextureSidePx = 8192;

using Eye = std::optional<Eigen::Vector3f>;  // in the site [m]

/// Makes one texture of a person's pictures, with the viewer's blending of a surface that is seen
/// along its normals, or by `eye_site` (`SurfaceColours`). The texels have the density of the
/// pictures, or less if the texture would exceed `kMaxTextureSidePx`. Texels between charts
/// continue the colours beside them. The positions stay in the site. Deterministic.
TexturedMesh bake(const renderer::PersonModel& model, const Eye& eye_site = {});

/// The mesh of the model with a colour per position; without texture and coordinates.
struct ColouredMesh {
    std::vector<Eigen::Vector3f> positions;  // [m]
    std::vector<Eigen::Vector3f> colours;    // in [0, 1], sRGB
    std::vector<std::array<std::uint32_t, 3>> triangles;
};
ColouredMesh colour_vertices(const renderer::PersonModel& model, const Eye& eye_site = {});

/// `count` points, evenly over the surface, by its area. Deterministic.
PointCloud sample(const renderer::PersonModel& model, std::size_t count, const Eye& eye_site = {});

}  // namespace atrium::exporting
