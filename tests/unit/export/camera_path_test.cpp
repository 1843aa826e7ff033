#include "tools/export/camera_path.hpp"

#include "tests/support/temporary_folder.hpp"
#include "tests/unit/export/ball_person.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <fstream>
#include <numbers>

namespace atrium::exporting {
namespace {

TEST(CameraPath, LooksFromThePositionAtTheTargetUpright) {
    const Eigen::Vector3d eye(1, 2, 1.7);
    const Eigen::Vector3d target(-1, 0.5, 1);
    const geometry::RigidTransform pose = look_at(eye, target);
    const Eigen::Vector3d seen = pose.inverse() * target;
    EXPECT_LT(seen.head<2>().norm(), 1e-12);
    EXPECT_NEAR(seen.z(), (target - eye).norm(), 1e-12);
    EXPECT_NEAR((pose.rotation * Eigen::Vector3d::UnitX()).z(), 0.0, 1e-12) << "level";
    EXPECT_LT((pose.rotation * Eigen::Vector3d::UnitY()).z(), 0.0) << "+Y is down";
    const geometry::RigidTransform down = look_at({0, 0, 3}, {0, 0, 0});
    EXPECT_NEAR((down.rotation * Eigen::Vector3d::UnitZ()).z(), -1.0, 1e-12);
}

TEST(CameraPath, HasAKeyAtEachFrame) {
    const test::TemporaryFolder folder;
    std::ofstream(folder / "p.json")
        << R"({"keys": [{"time_s": 1, "position_m": [0, -3, 1], "target_m": [0, 0, 1], "fov_deg": 40},
                        {"time_s": 2, "position_m": [2, -3, 1], "target_m": [2, 0, 1], "fov_deg": 40}]})";
    const auto path = recording::ViewPath::load(folder / "p.json");
    ASSERT_TRUE(path) << path.error().message;
    Survey seen;
    // recorded 0.1 s after the capture
    for (const int ms : {1000, 1500, 2000}) {
        const Timestamp capture = testing::kBegin + std::chrono::milliseconds(ms - 100);
        seen.frames.push_back({capture, testing::kBegin + std::chrono::milliseconds(ms)});
    }
    const geometry::RigidTransform frame_from_world{Eigen::Quaterniond::Identity(), {0, 10, 0}};
    const CameraPath sampled = sample_path(*path, seen, testing::kBegin, frame_from_world);
    ASSERT_EQ(sampled.keys.size(), 3u);
    EXPECT_NEAR(sampled.fov_rad, 40 * std::numbers::pi / 180, 1e-12);
    EXPECT_NEAR(sampled.keys[2].time_s, 1.0, 1e-9);
    EXPECT_LT((sampled.keys[0].frame_from_camera.translation - Eigen::Vector3d(0, 7, 1)).norm(),
              1e-9);
    EXPECT_LT((sampled.keys[1].frame_from_camera.translation - Eigen::Vector3d(1, 7, 1)).norm(),
              1e-6);
    EXPECT_LT((sampled.keys[2].frame_from_camera.translation - Eigen::Vector3d(2, 7, 1)).norm(),
              1e-9);
}

}  // namespace
}  // namespace atrium::exporting
