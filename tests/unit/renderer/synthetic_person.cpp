#include "tests/unit/renderer/synthetic_person.hpp"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace atrium::renderer::synthetic {

geometry::TriangleMesh mesh_of(const std::vector<Sphere>& spheres, int num_rings) {
    geometry::TriangleMesh mesh;
    const int num_sectors = 2 * num_rings;
    for (const Sphere& sphere : spheres) {
        const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
        const auto add = [&](double elevation, double azimuth) {
            mesh.vertices.push_back(sphere.centre +
                                    sphere.radius_m *
                                        Eigen::Vector3d(std::cos(elevation) * std::cos(azimuth),
                                                        std::cos(elevation) * std::sin(azimuth),
                                                        std::sin(elevation)));
        };
        add(-std::numbers::pi / 2, 0.0);
        for (int r = 1; r < num_rings; ++r) {
            for (int s = 0; s < num_sectors; ++s) {
                add(-std::numbers::pi / 2 + std::numbers::pi * r / num_rings,
                    2 * std::numbers::pi * s / num_sectors);
            }
        }
        add(std::numbers::pi / 2, 0.0);
        const auto last = static_cast<std::uint32_t>(mesh.vertices.size() - 1);
        const auto at = [&](int r, int s) {
            return first + 1 + static_cast<std::uint32_t>(r * num_sectors + s % num_sectors);
        };
        for (int s = 0; s < num_sectors; ++s) {
            mesh.triangles.push_back({first, at(0, s + 1), at(0, s)});
            for (int r = 0; r + 2 < num_rings; ++r) {
                mesh.triangles.push_back({at(r, s), at(r, s + 1), at(r + 1, s + 1)});
                mesh.triangles.push_back({at(r, s), at(r + 1, s + 1), at(r + 1, s)});
            }
            mesh.triangles.push_back({last, at(num_rings - 2, s), at(num_rings - 2, s + 1)});
        }
    }
    return mesh;
}

geometry::CalibratedCamera camera_at(const Eigen::Vector3d& position,
                                     const Eigen::Vector3d& target) {
    const Eigen::Vector3d z = (target - position).normalized();
    const Eigen::Vector3d x = z.cross(Eigen::Vector3d::UnitZ()).normalized();
    Eigen::Matrix3d camera_from_site;
    camera_from_site << x.transpose(), z.cross(x).transpose(), z.transpose();
    geometry::CalibratedCamera camera;
    camera.name = "synthetic";
    camera.intrinsics = {
        .width = 640, .height = 480, .fx = 500.0, .fy = 500.0, .cx = 319.5, .cy = 239.5};
    camera.camera_from_site.rotation = Eigen::Quaterniond(camera_from_site);
    camera.camera_from_site.translation = -(camera_from_site * position);
    return camera;
}

std::vector<geometry::CalibratedCamera> ring(int count, const Eigen::Vector3d& target) {
    std::vector<geometry::CalibratedCamera> cameras;
    for (int i = 0; i < count; ++i) {
        const double angle = 2 * std::numbers::pi * i / count;
        const double height = i % 2 == 0 ? 0.3 : 1.2;
        cameras.push_back(camera_at(
            target + Eigen::Vector3d(3.0 * std::cos(angle), 3.0 * std::sin(angle), height),
            target));
    }
    return cameras;
}

bool hit(const std::vector<Sphere>& spheres,
         const Eigen::Vector3d& origin,
         const Eigen::Vector3d& direction,
         Eigen::Vector3d& p) {
    double nearest = std::numeric_limits<double>::infinity();
    for (const Sphere& sphere : spheres) {
        const Eigen::Vector3d d = direction.normalized();
        const Eigen::Vector3d to_centre = sphere.centre - origin;
        const double along = to_centre.dot(d);
        const double miss_sq = to_centre.squaredNorm() - along * along;
        const double half_sq = sphere.radius_m * sphere.radius_m - miss_sq;
        if (half_sq < 0.0 || along < 0.0) continue;
        const double distance = along - std::sqrt(half_sq);
        if (distance >= nearest) continue;
        nearest = distance;
        p = origin + distance * d;
    }
    return std::isfinite(nearest);
}

CameraPicture picture_of(const std::vector<Sphere>& spheres,
                         const geometry::CalibratedCamera& camera,
                         const Colour& colour) {
    const geometry::RigidTransform site_from_camera = camera.camera_from_site.inverse();
    // generous box around the spheres' outlines, on even pixels
    double x0 = 1e9, y0 = 1e9, x1 = -1e9, y1 = -1e9;
    for (const Sphere& sphere : spheres) {
        const Eigen::Vector3d p = camera.camera_from_site * sphere.centre;
        const Eigen::Vector2d px = camera.intrinsics.distort(camera.intrinsics.project(p));
        const double reach =
            1.2 * camera.intrinsics.fx * sphere.radius_m / (p.z() - sphere.radius_m);
        x0 = std::min(x0, px.x() - reach);
        x1 = std::max(x1, px.x() + reach);
        y0 = std::min(y0, px.y() - reach);
        y1 = std::max(y1, px.y() + reach);
    }
    CameraPicture picture;
    picture.camera = camera;
    const auto even = [](double v, int limit) {
        return std::clamp(static_cast<int>(v) / 2 * 2, 0, limit);
    };
    picture.crop_px = {even(x0, camera.intrinsics.width), even(y0, camera.intrinsics.height), 0, 0};
    picture.crop_px.width = even(x1, camera.intrinsics.width) - picture.crop_px.x;
    picture.crop_px.height = even(y1, camera.intrinsics.height) - picture.crop_px.y;
    picture.width = picture.crop_px.width / 2;
    picture.height = picture.crop_px.height / 2;
    for (int j = 0; j < picture.height; ++j) {
        for (int i = 0; i < picture.width; ++i) {
            const Eigen::Vector2d px(picture.crop_px.x + 2 * i + 0.5,
                                     picture.crop_px.y + 2 * j + 0.5);
            const auto undistorted = camera.intrinsics.undistort(px);
            Eigen::Vector3d p;
            const bool is_hit = undistorted && hit(spheres,
                                                   site_from_camera.translation,
                                                   site_from_camera.rotation *
                                                       camera.intrinsics.ray_camera(*undistorted),
                                                   p);
            // bright colours outside the mask show up if they leak into a result
            const Eigen::Vector3d c = is_hit ? colour(p) : Eigen::Vector3d(1.0, 0.0, 1.0);
            for (int k = 0; k < 3; ++k)
                picture.rgba.push_back(static_cast<std::uint8_t>(std::lround(255.0 * c[k])));
            picture.rgba.push_back(is_hit ? 255 : 0);
        }
    }
    return picture;
}

}  // namespace atrium::renderer::synthetic
