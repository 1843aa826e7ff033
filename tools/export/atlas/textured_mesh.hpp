#pragma once

#include <Eigen/Core>

#include <array>
#include <cstdint>
#include <vector>

namespace atrium::exporting {

/// Rows from the top, R, G, B, A; A is 255.
struct Picture {
    int width = 0;
    int height = 0;
    std::vector<std::uint8_t> rgba;
};

/// A mesh with one texture. A position has one vertex per chart that it belongs to.
struct TexturedMesh {
    std::vector<Eigen::Vector3f> positions;               // [m]
    std::vector<std::uint32_t> position_of;               // per vertex
    std::vector<Eigen::Vector2f> uvs;                     // per vertex; (0, 0): upper left corner
    std::vector<std::array<std::uint32_t, 3>> triangles;  // of vertices; counter-clockwise
    Picture texture;
};

/// Points of a surface. As many normals and colours as positions.
struct PointCloud {
    std::vector<Eigen::Vector3f> positions;  // [m]
    std::vector<Eigen::Vector3f> normals;    // length 1
    std::vector<Eigen::Vector3f> colours;    // in [0, 1], sRGB
};

}  // namespace atrium::exporting
