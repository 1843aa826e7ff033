#include "tools/calibrate/front.hpp"

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>

namespace atrium::calibrate {
namespace {

TEST(Front, TurnsTheFrameAndNamesTheCameraAhead) {
    std::vector<geometry::CalibratedCamera> cameras(6);
    for (std::size_t i = 0; i < cameras.size(); ++i) {
        const double angle = 0.4 + std::numbers::pi / 3.0 * static_cast<double>(i);
        geometry::RigidTransform site_from_camera;
        site_from_camera.rotation = Eigen::AngleAxisd(angle, Eigen::Vector3d(1, 2, 3).normalized());
        site_from_camera.translation = {3.0 * std::cos(angle), 3.0 * std::sin(angle), 1.5};
        cameras[i].name = "cam" + std::to_string(i);
        cameras[i].camera_from_site = site_from_camera.inverse();
    }
    EXPECT_EQ(front_camera(cameras), "cam0");
    const auto before = cameras;
    EXPECT_FALSE(turn_front_towards("door", cameras));
    for (const auto& camera : before) {
        ASSERT_TRUE(turn_front_towards(camera.name, cameras));
        EXPECT_EQ(front_camera(cameras), camera.name);
        for (std::size_t i = 0; i < cameras.size(); ++i) {
            const Eigen::Vector3d at = cameras[i].centre_site();
            if (cameras[i].name == camera.name) {
                EXPECT_LT((at - Eigen::Vector3d(3.0, 0.0, 1.5)).norm(), 1e-9);
            }
            // what a camera sees of another one is the same
            const Eigen::Vector3d towards =
                cameras[i].camera_from_site.rotation * (at - cameras[0].centre_site());
            const Eigen::Vector3d before_towards =
                before[i].camera_from_site.rotation *
                (before[i].centre_site() - before[0].centre_site());
            EXPECT_LT((towards - before_towards).norm(), 1e-9);
        }
    }
    EXPECT_EQ(front_text("door"),
              "front: people who look towards 'door' look along +X, into the world");
}

}  // namespace
}  // namespace atrium::calibrate
