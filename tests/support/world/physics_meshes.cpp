#include "tests/support/world/physics_meshes.hpp"

#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <numbers>
#include <tuple>

namespace atrium::physics_test {
namespace {

using Key = std::tuple<int, int, int>;

// The surface of the cube [-1, 1]^3 with `n` squares along each edge and shared vertices.
geometry::TriangleMesh make_cube(int n) {
    geometry::TriangleMesh mesh;
    std::map<Key, std::uint32_t> index_of;
    const auto vertex = [&](const Eigen::Vector3i& p) {
        const auto [found, is_new] = index_of.try_emplace(
            Key(p.x(), p.y(), p.z()), static_cast<std::uint32_t>(mesh.vertices.size()));
        if (is_new) mesh.vertices.push_back((2.0 / n * p.cast<double>()).array() - 1.0);
        return found->second;
    };
    for (int axis = 0; axis < 3; ++axis) {
        for (const int side : {0, n}) {
            for (int i = 0; i < n; ++i) {
                for (int j = 0; j < n; ++j) {
                    std::array<std::uint32_t, 4> corner;
                    constexpr std::array<std::array<int, 2>, 4> kSteps{
                        {{0, 0}, {1, 0}, {1, 1}, {0, 1}}};
                    for (std::size_t c = 0; c < 4; ++c) {
                        Eigen::Vector3i p;
                        p[axis] = side;
                        p[(axis + 1) % 3] = i + kSteps[c][0];
                        p[(axis + 2) % 3] = j + kSteps[c][1];
                        corner[c] = vertex(p);
                    }
                    if (side == 0) std::swap(corner[1], corner[3]);
                    mesh.triangles.push_back({corner[0], corner[1], corner[2]});
                    mesh.triangles.push_back({corner[0], corner[2], corner[3]});
                }
            }
        }
    }
    return mesh;
}

}  // namespace

geometry::TriangleMesh make_box_mesh(const Eigen::Vector3d& size_m,
                                     const geometry::RigidTransform& world_from_box,
                                     int num_cuts) {
    geometry::TriangleMesh mesh = make_cube(num_cuts);
    for (Eigen::Vector3d& v : mesh.vertices)
        v = world_from_box * (0.5 * v.cwiseProduct(size_m)).eval();
    return mesh;
}

geometry::TriangleMesh make_sphere_mesh(double radius_m,
                                        const Eigen::Vector3d& centre,
                                        int num_cuts) {
    geometry::TriangleMesh mesh = make_cube(num_cuts);
    for (Eigen::Vector3d& v : mesh.vertices) v = centre + radius_m * v.normalized();
    return mesh;
}

geometry::TriangleMesh make_person_mesh(const Eigen::Vector3d& feet, double reach_m, int num_cuts) {
    geometry::TriangleMesh mesh;
    const auto box = [&](const Eigen::Vector3d& size, const Eigen::Vector3d& centre) {
        append(
            mesh,
            make_box_mesh(size, {Eigen::Quaterniond::Identity(), feet + centre}, num_cuts / 2 + 3));
    };
    append(mesh, make_sphere_mesh(0.12, feet + Eigen::Vector3d(0.0, 0.0, 1.65), num_cuts));
    box({0.22, 0.42, 0.65}, {0.0, 0.0, 1.18});
    for (const double side : {-1.0, 1.0}) {
        box({0.15, 0.15, 0.85}, {0.0, side * 0.12, 0.425});
        box({reach_m, 0.09, 0.09}, {0.11 + 0.5 * reach_m, side * 0.17, 1.3});
    }
    return mesh;
}

}  // namespace atrium::physics_test
