#pragma once

#include "core/geometry/pinhole_camera.hpp"
#include "core/geometry/triangle_mesh.hpp"
#include "core/image/image.hpp"
#include "site_node/refine/luma_picture.hpp"

#include <Eigen/Core>

#include <cstdint>
#include <vector>

namespace atrium::refine {

/// A round block with a hollow in its top, whose rim hides nothing of it: its visual hull is the
/// block without the hollow.
struct Dish {
    double radius_m = 0.25;
    double height_m = 0.2;
    double rim_radius_m = 0.2;  // of the hollow
    double depth_m = 0.06;      // of the hollow, in the middle

    /// Signed distance to the surface [m], or less than it where several surfaces meet; < 0 inside.
    double distance_m(const Eigen::Vector3d& point_site) const;

private:
    double hollow_radius_m() const;
};

/// The dish as cameras around and above it see it. Its surface has a random pattern.
struct DishScene {
    std::vector<geometry::CalibratedCamera> cameras;
    std::vector<image::YuvImage> pictures;
    std::vector<image::Mask> masks;
    std::vector<image::PixelRect> subjects;
    std::vector<std::vector<std::vector<Eigen::Vector2d>>> contours;  // per camera [px]
    geometry::TriangleMesh hull;

    std::vector<PictureView> views() const;
};

/// `contrast` 0: all of its surface is grey.
DishScene film_dish(const Dish& dish, std::uint64_t seed, double contrast = 1.0);

}  // namespace atrium::refine
