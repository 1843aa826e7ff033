#include "viewer/overlay/debug_view.hpp"

#include "viewer/overlay/shape_wires.hpp"

#include <Eigen/Geometry>
#include <gtest/gtest.h>

namespace atrium::viewer {
namespace {

const Eigen::Vector3f kColour(1, 0, 0);

// Number of lines with an end there.
std::size_t num_ends_at(const std::vector<renderer::Line>& lines, const Eigen::Vector3d& p_world) {
    std::size_t num = 0;
    for (const renderer::Line& line : lines) {
        for (const renderer::Line::End& end : {line.from, line.to})
            num += (end.at_world.cast<double>() - p_world).norm() < 1e-5 ? 1U : 0U;
    }
    return num;
}

TEST(DebugView, BoxHasTwelveEdges) {
    Eigen::Isometry3d world_from_box = Eigen::Isometry3d::Identity();
    world_from_box.translate(Eigen::Vector3d(1, 2, 3));
    world_from_box.rotate(Eigen::AngleAxisd(0.3, Eigen::Vector3d::UnitX()));
    std::vector<renderer::Line> lines;
    append_box(world_from_box.matrix(), {0.2, 0.4, 0.6}, kColour, lines);
    EXPECT_EQ(lines.size(), 12U);
    for (const double x : {-0.1, 0.1})
        for (const double y : {-0.2, 0.2})
            for (const double z : {-0.3, 0.3})
                EXPECT_EQ(num_ends_at(lines, world_from_box * Eigen::Vector3d(x, y, z)), 3U);
}

TEST(DebugView, FrustumReachesFromTheCameraToItsPictureCorners) {
    geometry::CalibratedCamera camera;
    camera.name = "cam0";
    camera.intrinsics = {.width = 640, .height = 480, .fx = 500, .fy = 510, .cx = 310, .cy = 250};
    camera.camera_from_site.rotation =
        Eigen::Quaterniond(Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, 2, 3).normalized()));
    camera.camera_from_site.translation = {0.1, 0.2, 2.5};
    Eigen::Isometry3d world_from_site = Eigen::Isometry3d::Identity();
    world_from_site.translate(Eigen::Vector3d(3, 0, 0));
    std::vector<renderer::Line> lines;
    append_frustum(camera, world_from_site.matrix(), 0.5, kColour, lines);
    EXPECT_EQ(lines.size(), 8U);
    EXPECT_EQ(num_ends_at(lines, world_from_site * camera.centre_site()), 4U);
    for (const auto& [x_px, y_px] : {std::pair(-0.5, -0.5), {639.5, -0.5}, {639.5, 479.5}}) {
        bool is_found = false;
        for (const renderer::Line& line : lines) {
            const Eigen::Vector3d p_camera =
                camera.camera_from_site *
                (world_from_site.inverse() * line.from.at_world.cast<double>());
            if (std::abs(p_camera.z() - 0.5) > 1e-4) continue;
            is_found |=
                (camera.intrinsics.project(p_camera) - Eigen::Vector2d(x_px, y_px)).norm() < 1e-2;
        }
        EXPECT_TRUE(is_found) << x_px << ' ' << y_px;
    }
}

}  // namespace
}  // namespace atrium::viewer
