#include "viewer/renderer/drawing/shape_mesh.hpp"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace atrium::renderer {
namespace {

constexpr int kNumSectors = 32;
constexpr int kNumRings = 8;  // per half of a sphere

// `u` points to the right of the texture, `v` up.
void add_quad(const Eigen::Vector3f& centre,
              const Eigen::Vector3f& u,
              const Eigen::Vector3f& v,
              ShapeMesh& mesh) {
    const auto first = static_cast<std::uint32_t>(mesh.corners.size());
    const Eigen::Vector3f normal = u.cross(v).normalized();
    for (const auto& [s, t] : {std::pair{-1.0f, -1.0f}, {1.0f, -1.0f}, {1.0f, 1.0f}, {-1.0f, 1.0f}})
        mesh.corners.push_back(
            {centre + s * u + t * v, normal, {0.5f + 0.5f * s, 0.5f - 0.5f * t}});
    for (const std::uint32_t i : {0u, 1u, 2u, 0u, 2u, 3u}) mesh.indices.push_back(first + i);
}

// One ring of a surface of revolution around z.
struct Ring {
    float radius;
    float z;
    float normal_radial;
    float normal_z;
    float down;  // texture coordinate from top to bottom, 0 to 1
};

constexpr std::uint32_t kStride = kNumSectors + 1;  // vertices per ring

// Coarser indices of a surface of revolution whose vertices begin at `first`: every `step`th sector
// and, in the halves of a sphere, every `step`th ring.
void add_bands(std::size_t num_rings,
               std::uint32_t first,
               std::uint32_t step,
               std::vector<std::uint32_t>& indices) {
    const bool is_sphere = num_rings == 2 * (kNumRings + 1);
    std::uint32_t lower = 0;
    while (lower + 1 < num_rings) {
        const bool is_between_halves = lower == kNumRings;
        const std::uint32_t upper = lower + (is_sphere && !is_between_halves ? step : 1);
        for (std::uint32_t i = 0; i < kNumSectors; i += step) {
            const std::uint32_t a = first + lower * kStride + i;
            const std::uint32_t b = first + upper * kStride + i;
            for (const std::uint32_t index : {a, a + step, b + step, a, b + step, b})
                indices.push_back(index);
        }
        lower = upper;
    }
}

// `flat_radius`: radius of an end, which the texture covers flat instead of around; 0 elsewhere.
void add_revolution(const std::vector<Ring>& rings, float flat_radius, ShapeMesh& mesh) {
    const auto first = static_cast<std::uint32_t>(mesh.corners.size());
    for (const Ring& ring : rings) {
        for (int i = 0; i <= kNumSectors; ++i) {
            const float turn = static_cast<float>(i) / static_cast<float>(kNumSectors);
            const float angle = 2.0f * std::numbers::pi_v<float> * turn;
            const float c = std::cos(angle);
            const float s = std::sin(angle);
            Eigen::Vector2f place(turn, ring.down);
            if (flat_radius > 0.0f) {
                const float out = 0.5f * ring.radius / flat_radius;
                place = {0.5f + out * c, 0.5f - out * s};
            }
            mesh.corners.push_back({{ring.radius * c, ring.radius * s, ring.z},
                                    {ring.normal_radial * c, ring.normal_radial * s, ring.normal_z},
                                    place});
        }
    }
    add_bands(rings.size(), first, 1, mesh.indices);
    add_bands(rings.size(), first, 2, mesh.coarser[0]);
    add_bands(rings.size(), first, 4, mesh.coarser[1]);
}

// Rings from the south pole to the north pole; the halves are `half_gap` away from the centre.
std::vector<Ring> sphere_rings(float radius, float half_gap) {
    std::vector<Ring> rings;
    // arc length from pole to pole
    const float length = std::numbers::pi_v<float> * radius + 2.0f * half_gap;
    for (int side = -1; side <= 1; side += 2) {
        for (int i = 0; i <= kNumRings; ++i) {
            const float t = static_cast<float>(side < 0 ? i - kNumRings : i) / kNumRings;
            const float elevation = t * std::numbers::pi_v<float> / 2.0f;
            const float c = std::cos(elevation);
            const float s = std::sin(elevation);
            const float gap = static_cast<float>(side) * half_gap;
            rings.push_back(
                {radius * c, radius * s + gap, c, s, 0.5f - (radius * elevation + gap) / length});
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
            add_quad(-x, -y, z, mesh);
            add_quad(y, -x, z, mesh);
            add_quad(-y, x, z, mesh);
            add_quad(z, x, y, mesh);
            add_quad(-z, y, x, mesh);
            break;
        case ShapeKind::kSphere:
            add_revolution(sphere_rings(half.x(), 0.0f), 0.0f, mesh);
            break;
        case ShapeKind::kCapsule:
            add_revolution(sphere_rings(half.x(), std::max(0.0f, half.z() - half.x())), 0.0f, mesh);
            break;
        case ShapeKind::kCylinder: {
            const float r = half.x();
            const float h = half.z();
            add_revolution({{0.0f, -h, 0.0f, -1.0f, 0.0f}, {r, -h, 0.0f, -1.0f, 0.0f}}, r, mesh);
            add_revolution({{r, -h, 1.0f, 0.0f, 1.0f}, {r, h, 1.0f, 0.0f, 0.0f}}, 0.0f, mesh);
            add_revolution({{r, h, 0.0f, 1.0f, 0.0f}, {0.0f, h, 0.0f, 1.0f, 0.0f}}, r, mesh);
            break;
        }
        case ShapeKind::kPlane:
            add_quad(Eigen::Vector3f::Zero(), x, y, mesh);
            for (ShapeMesh::Corner& corner : mesh.corners)
                corner.texture_place =
                    projected_place(corner.position_object, corner.normal_object);
            break;
    }
    return mesh;
}

Eigen::Vector2f projected_place(const Eigen::Vector3f& p, const Eigen::Vector3f& normal) {
    Eigen::Index axis = 0;
    normal.cwiseAbs().maxCoeff(&axis);
    const float side = normal[axis] < 0.0f ? -1.0f : 1.0f;
    if (axis == 0) return {side * p.y(), -p.z()};
    if (axis == 1) return {-side * p.x(), -p.z()};
    return {side * p.x(), -p.y()};
}

}  // namespace atrium::renderer
