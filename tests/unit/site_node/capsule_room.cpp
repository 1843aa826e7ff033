#include "tests/unit/site_node/capsule_room.hpp"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <random>

namespace atrium::site_node::test {
namespace {

// How far along the unit vector `ray` from `origin` the line passes the capsule's segment nearer
// than the radius; infinite if it does not. The squared distance along the segment is a parabola.
double distance_to(const Eigen::Vector3d& origin,
                   const Eigen::Vector3d& ray,
                   const Capsule& capsule) {
    const auto across = [&](const Eigen::Vector3d& v) -> Eigen::Vector3d {
        return v - v.dot(ray) * ray;
    };
    const Eigen::Vector3d from = across(capsule.a - origin);
    const Eigen::Vector3d along = across(capsule.b - capsule.a);
    const double t = std::clamp(-from.dot(along) / std::max(along.squaredNorm(), 1e-12), 0.0, 1.0);
    if ((from + t * along).norm() > capsule.radius_m)
        return std::numeric_limits<double>::infinity();
    return (capsule.a + t * (capsule.b - capsule.a) - origin).dot(ray);
}

}  // namespace

std::vector<Capsule> make_body(const Eigen::Vector3d& floor_site) {
    std::vector<Capsule> body{{{0, 0, 1.55}, {0, 0, 1.65}, 0.10},  // head
                              {{0, 0, 0.95}, {0, 0, 1.35}, 0.16},  // trunk
                              {{0, -0.1, 0.85}, {0, -0.14, 0.08}, 0.07},
                              {{0, 0.1, 0.85}, {0, 0.14, 0.08}, 0.07},
                              {{0, -0.15, 1.4}, {0.1, -0.5, 1.2}, 0.05},
                              {{0, 0.15, 1.4}, {0.1, 0.5, 1.5}, 0.05}};
    for (Capsule& limb : body) {
        limb.a += floor_site;
        limb.b += floor_site;
    }
    return body;
}

image::Plane limbs_in_front(std::span<const Capsule> body,
                            const geometry::CalibratedCamera& camera) {
    const geometry::PinholeCamera& lens = camera.intrinsics;
    const Eigen::Matrix3d site_from_camera =
        camera.camera_from_site.rotation.conjugate().toRotationMatrix();
    const Eigen::Vector3d centre = camera.centre_site();
    image::Plane limbs(lens.width, lens.height);
    for (int y = 0; y < limbs.height; ++y) {
        for (int x = 0; x < limbs.width; ++x) {
            const auto straight = lens.undistort(Eigen::Vector2d(x, y));
            if (!straight) continue;
            const Eigen::Vector3d ray =
                (site_from_camera * lens.ray_camera(*straight)).normalized();
            double nearest = std::numeric_limits<double>::infinity();
            for (std::size_t i = 0; i < body.size(); ++i) {
                const double distance = distance_to(centre, ray, body[i]);
                if (!(distance < nearest)) continue;
                nearest = distance;
                limbs.row(y)[x] = static_cast<std::uint8_t>(i + 1);
            }
        }
    }
    return limbs;
}

image::Mask draw(std::span<const Capsule> body, const geometry::CalibratedCamera& camera) {
    image::Mask mask = limbs_in_front(body, camera);
    for (std::uint8_t& pixel : mask.data) pixel = pixel != 0 ? 255 : 0;
    return mask;
}

capture::Metaframe take_pictures(std::span<const Capsule> body, const config::Rig& rig) {
    capture::Metaframe metaframe;
    metaframe.frame_id = 1;
    metaframe.capture_time = {1'000'000'000};
    for (std::size_t i = 0; i < rig.cameras.size(); ++i) {
        const geometry::PinholeCamera& lens = rig.cameras[i].intrinsics;
        auto image = std::make_shared<image::YuvImage>();
        image->y = image::Plane(lens.width, lens.height, 90);
        image->u = image->v = image::Plane(lens.width / 2, lens.height / 2, 128);
        metaframe.frames.push_back(
            {i,
             metaframe.capture_time,
             image::RawImage(std::move(image)),
             std::make_shared<const image::Mask>(draw(body, rig.cameras[i]))});
    }
    return metaframe;
}

std::vector<Eigen::Vector3d> points_inside(std::span<const Capsule> body,
                                           double margin_m,
                                           std::size_t count) {
    std::mt19937_64 random(3);
    std::uniform_real_distribution<double> unit(0.0, 1.0);
    std::normal_distribution<double> normal;
    std::vector<Eigen::Vector3d> points;
    while (points.size() < count) {
        const Capsule& limb = body[points.size() % body.size()];
        const Eigen::Vector3d direction(normal(random), normal(random), normal(random));
        points.push_back(limb.a + unit(random) * (limb.b - limb.a) +
                         std::cbrt(unit(random)) * (limb.radius_m - margin_m) *
                             direction.normalized());
    }
    return points;
}

}  // namespace atrium::site_node::test
