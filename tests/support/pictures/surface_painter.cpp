#include "tests/support/pictures/surface_painter.hpp"

#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <cstdint>
#include <limits>
#include <random>

namespace atrium::test {
namespace {

const Eigen::Vector3d kLamp(0.6, -0.4, 2.8);
constexpr std::uint8_t kRoom = 110;
constexpr double kNoise = 2.0;  // [grey levels] of one pixel

double lit(const Eigen::Vector3d& normal, const Eigen::Vector3d& place) {
    const double towards_lamp = std::max(0.0, normal.dot((kLamp - place).normalized()));
    return 0.1 + 0.6 * (0.88 + 0.12 * normal.z()) + 0.4 * towards_lamp;
}

std::vector<Eigen::Vector3d> normals_of(const geometry::TriangleMesh& mesh) {
    std::vector<Eigen::Vector3d> normals(mesh.vertices.size(), Eigen::Vector3d::Zero());
    for (const auto& [a, b, c] : mesh.triangles) {
        const Eigen::Vector3d normal =
            (mesh.vertices[b] - mesh.vertices[a]).cross(mesh.vertices[c] - mesh.vertices[a]);
        for (const std::uint32_t vertex : {a, b, c}) normals[vertex] += normal;
    }
    for (Eigen::Vector3d& normal : normals) normal.normalize();
    return normals;
}

double lattice_value(int x, int y, int z) {
    auto bits = static_cast<std::uint32_t>(x) * 374761393U +
                static_cast<std::uint32_t>(y) * 668265263U +
                static_cast<std::uint32_t>(z) * 2147483647U;
    bits = (bits ^ (bits >> 13U)) * 1274126177U;
    return static_cast<double>((bits ^ (bits >> 16U)) & 0xFFFFU) / 32767.5 - 1.0;
}

}  // namespace

double noise_at(const Eigen::Vector3d& place, double per_m) {
    const Eigen::Vector3d scaled = per_m * place;
    const Eigen::Vector3i cell = scaled.array().floor().cast<int>();
    const Eigen::Vector3d in_cell = scaled - cell.cast<double>();
    double sum = 0.0;
    for (int corner = 0; corner < 8; ++corner) {
        const Eigen::Vector3i step(corner & 1, (corner >> 1) & 1, corner >> 2);
        double weight = 1.0;
        for (int axis = 0; axis < 3; ++axis)
            weight *= step[axis] != 0 ? in_cell[axis] : 1.0 - in_cell[axis];
        sum +=
            weight * lattice_value(cell.x() + step.x(), cell.y() + step.y(), cell.z() + step.z());
    }
    return sum;
}

SurfacePainter::SurfacePainter(const geometry::CalibratedCamera& camera)
    : camera_(camera), mask_(camera.intrinsics.width, camera.intrinsics.height) {
    assert(!camera.intrinsics.has_distortion());
    picture_.y = image::Plane(mask_.width, mask_.height);
    picture_.u = image::Plane(mask_.width / 2, mask_.height / 2, 128);
    picture_.v = picture_.u;
    // drawing from the distribution would take longer than everything else
    Random random(1);
    std::normal_distribution<double> noise(0.0, kNoise);
    for (double& value : noise_) value = noise(random);
}

void SurfacePainter::draw(const geometry::TriangleMesh& mesh_site,
                          std::span<const Eigen::Vector3d> places_at_rest,
                          const Paint& paint,
                          Random& random) {
    const auto noise = [&] { return noise_[random() % noise_.size()]; };
    const int width = mask_.width;
    std::ranges::fill(mask_.data, std::uint8_t{0});
    for (std::uint8_t& value : picture_.y.data)
        value = static_cast<std::uint8_t>(std::lround(kRoom + noise()));
    depth_m_.assign(mask_.data.size(), std::numeric_limits<float>::max());
    const std::vector<Eigen::Vector3d> normals = normals_of(mesh_site);
    std::vector<Eigen::Vector3d> projected;  // pixel, depth
    for (const Eigen::Vector3d& vertex : mesh_site.vertices) {
        const Eigen::Vector3d p = camera_.camera_from_site * vertex;
        const Eigen::Vector2d px = camera_.intrinsics.project(p);
        projected.emplace_back(px.x(), px.y(), p.z());
    }
    for (const auto& triangle : mesh_site.triangles) {
        const std::array<Eigen::Vector3d, 3> at{
            projected[triangle[0]], projected[triangle[1]], projected[triangle[2]]};
        const Eigen::Vector2d u = (at[1] - at[0]).head<2>();
        const Eigen::Vector2d v = (at[2] - at[0]).head<2>();
        const double area = u.x() * v.y() - u.y() * v.x();
        if (area >= 0.0) continue;  // faces away; rows grow downwards
        const auto bound = [&](int axis, bool upper, int size) {
            const auto [low, high] = std::minmax({at[0][axis], at[1][axis], at[2][axis]});
            return upper ? std::min(size - 1, static_cast<int>(std::floor(high)))
                         : std::max(0, static_cast<int>(std::ceil(low)));
        };
        for (int y = bound(1, false, mask_.height); y <= bound(1, true, mask_.height); ++y) {
            for (int x = bound(0, false, width); x <= bound(0, true, width); ++x) {
                const Eigen::Vector2d off(x - at[0].x(), y - at[0].y());
                const double second = (off.x() * v.y() - off.y() * v.x()) / area;
                const double third = (u.x() * off.y() - u.y() * off.x()) / area;
                Eigen::Vector3d shares(1.0 - second - third, second, third);
                if (shares.minCoeff() < 0.0) continue;
                for (int i = 0; i < 3; ++i) shares[i] /= at[static_cast<std::size_t>(i)].z();
                const double depth = 1.0 / shares.sum();
                const std::size_t pixel =
                    static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
                    static_cast<std::size_t>(x);
                if (depth >= static_cast<double>(depth_m_[pixel])) continue;
                depth_m_[pixel] = static_cast<float>(depth);
                shares *= depth;
                const auto mixed = [&](const auto& values) {
                    return Eigen::Vector3d(shares[0] * values[triangle[0]] +
                                           shares[1] * values[triangle[1]] +
                                           shares[2] * values[triangle[2]]);
                };
                const double value = paint(mixed(places_at_rest)) * lit(mixed(normals).normalized(),
                                                                        mixed(mesh_site.vertices)) +
                                     noise();
                picture_.y.data[pixel] =
                    static_cast<std::uint8_t>(std::lround(std::clamp(value, 0.0, 255.0)));
                mask_.data[pixel] = 255;
            }
        }
    }
}

}  // namespace atrium::test
