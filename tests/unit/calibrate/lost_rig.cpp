#include "lost_rig.hpp"

#include "filmed_room.hpp"

#include <random>

namespace atrium::calibrate_test {

using calibrate::Board;
using calibrate::BoardCamera;
using calibrate::BoardPoints;

LostRig lost_rig(std::uint32_t seed) {
    std::mt19937 rng(seed);
    std::uniform_real_distribution<double> vary(-1.0, 1.0);
    ShowOptions options;
    options.seed = seed;
    LostRig lost;
    lost.rig_from_site = {
        Eigen::Quaterniond(vary(rng), vary(rng), vary(rng), vary(rng)).normalized(),
        {2.0 * vary(rng), 2.0 * vary(rng), 2.0 * vary(rng)}};
    for (geometry::CalibratedCamera camera : show({large_board()}, options).cameras) {
        camera.camera_from_site = camera.camera_from_site * lost.rig_from_site.inverse();
        lost.rig.cameras.push_back(camera);
    }
    return lost;
}

Eigen::Vector2d seen_px(const geometry::CalibratedCamera& camera,
                        const Eigen::Vector3d& point_rig) {
    const auto& lens = camera.intrinsics;
    return lens.distort(lens.project(camera.camera_from_site * point_rig));
}

BoardPoints lying(const LostRig& lost,
                  const Board& board,
                  const geometry::RigidTransform& site_from_board,
                  std::uint32_t seed) {
    std::mt19937 rng(seed);
    std::normal_distribution<double> noise(0.0, 0.15);
    BoardPoints points;
    for (const auto& camera : lost.rig.cameras) {
        BoardCamera seen{camera.name, camera.intrinsics.width, camera.intrinsics.height, 4, {}};
        for (std::uint32_t instant = 0; instant < 4; ++instant) {
            for (std::uint32_t i = 0; i < board.num_corners(); ++i) {
                const Eigen::Vector2d px =
                    seen_px(camera, lost.rig_from_site * (site_from_board * board.corner_m(i)));
                seen.corners.push_back({instant, i, px + Eigen::Vector2d(noise(rng), noise(rng))});
            }
        }
        points.push_back(std::move(seen));
    }
    return points;
}

}  // namespace atrium::calibrate_test
