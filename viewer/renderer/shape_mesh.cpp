#include "viewer/renderer/shape_mesh.hpp"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace atrium::renderer {
namespace {

constexpr int kNumSectors = 32;
constexpr int kNumRings = 8;  // of half a sphere

void add_quad(const Eigen::Vector3f& centre,
              const Eigen::Vector3f& u,
              const Eigen::Vector3f& v,
              ShapeMesh& mesh) {
    const auto first = static_cast<std::uint32_t>(mesh.corners.size());
    const Eigen::Vector3f normal = u.cross(v).normalized();
    for (const auto& [s, t] : {std::pair{-1.0f, -1.0f}, {1.0f, -1.0f}, {1.0f, 1.0f}, {-1.0f, 1.0f}})
        mesh.corners.push_back({centre + s * u + t * v, normal});
    for (const std::uint32_t i : {0u, 1u, 2u, 0u, 2u, 3u}) mesh.indices.push_back(first + i);
}

// One ring of a surface of revolution around z.
struct Ring {
    float radius;
    float z;
    float normal_radial;
    float normal_z;
};

void add_revolution(const std::vector<Ring>& rings, ShapeMesh& mesh) {
    const auto first = static_cast<std::uint32_t>(mesh.corners.size());
    constexpr std::uint32_t kStride = kNumSectors + 1;
    for (const Ring& ring : rings) {
        for (int i = 0; i <= kNumSectors; ++i) {
            const float angle = 2.0f * std::numbers::pi_v<float> * static_cast<float>(i) /
                                static_cast<float>(kNumSectors);
            const float c = std::cos(angle);
            const float s = std::sin(angle);
            mesh.corners.push_back(
                {{ring.radius * c, ring.radius * s, ring.z},
                 {ring.normal_radial * c, ring.normal_radial * s, ring.normal_z}});
        }
    }
    for (std::uint32_t r = 0; r + 1 < rings.size(); ++r) {
        for (std::uint32_t i = 0; i < kNumSectors; ++i) {
            const std::uint32_t a = first + r * kStride + i;
            const std::uint32_t b = a + kStride;
            for (const std::uint32_t index : {a, a + 1, b + 1, a, b + 1, b})
                mesh.indices.push_back(index);
        }
    }
}

// From the south pole to the north pole; the halves `half_gap` away from the middle.
std::vector<Ring> sphere_rings(float radius, float half_gap) {
    std::vector<Ring> rings;
    for (int side = -1; side <= 1; side += 2) {
        for (int i = 0; i <= kNumRings; ++i) {
            const float t = static_cast<float>(side < 0 ? i - kNumRings : i) / kNumRings;
            const float elevation = t * std::numbers::pi_v<float> / 2.0f;
            const float c = std::cos(elevation);
            const float s = std::sin(elevation);
            rings.push_back({radius * c, radius * s + static_cast<float>(side) * half_gap, c, s});
        }
    }
    return rings;
}

}  // namespace

ShapeMesh make_shape(ShapeKind kind, const Eigen::Vector3d& size_m) {
    ShapeMesh mesh;
    const Eigen::Vector3f half = (0.5 * size_m).cast<float>();
    const Eigen::Vector3f x(half.x(), 0.0f, 0.0f);
    const Eigen::Vector3f y(0.0f, half.y(), 0.0f);
    const Eigen::Vector3f z(0.0f, 0.0f, half.z());
    switch (kind) {
        case ShapeKind::kBox:
            add_quad(x, y, z, mesh);
            add_quad(-x, z, y, mesh);
            add_quad(y, z, x, mesh);
            add_quad(-y, x, z, mesh);
            add_quad(z, x, y, mesh);
            add_quad(-z, y, x, mesh);
            break;
        case ShapeKind::kSphere:
            add_revolution(sphere_rings(half.x(), 0.0f), mesh);
            break;
        case ShapeKind::kCapsule:
            add_revolution(sphere_rings(half.x(), std::max(0.0f, half.z() - half.x())), mesh);
            break;
        case ShapeKind::kCylinder: {
            const float r = half.x();
            add_revolution({{0.0f, -half.z(), 0.0f, -1.0f}, {r, -half.z(), 0.0f, -1.0f}}, mesh);
            add_revolution({{r, -half.z(), 1.0f, 0.0f}, {r, half.z(), 1.0f, 0.0f}}, mesh);
            add_revolution({{r, half.z(), 0.0f, 1.0f}, {0.0f, half.z(), 0.0f, 1.0f}}, mesh);
            break;
        }
        case ShapeKind::kPlane:
            add_quad(Eigen::Vector3f::Zero(), x, y, mesh);
            break;
    }
    return mesh;
}

}  // namespace atrium::renderer
