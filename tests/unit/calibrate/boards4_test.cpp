// Real pictures: four webcams and a board, beside the calibration of another program.
#include "core/base/thread_pool.hpp"
#include "core/config/rig.hpp"
#include "tests/support/sanitized.hpp"
#include "tests/support/skips.hpp"
#include "tests/support/source_dir.hpp"
#include "tools/calibrate/board/film_boards.hpp"
#include "tools/calibrate/board/judge_board.hpp"
#include "tools/calibrate/board/solve_board.hpp"

#include <Eigen/Dense>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <map>

namespace atrium::calibrate {
namespace {

namespace fs = std::filesystem;

using CameraSet = std::vector<geometry::CalibratedCamera>;

CameraSet cameras_of(const Bundle& bundle) {
    CameraSet cameras;
    for (const BundleCamera& camera : bundle.cameras)
        cameras.push_back({camera.name, camera.intrinsics(), camera.camera_from_world()});
    return cameras;
}

struct Seen {
    std::size_t camera;
    Eigen::Vector2d px;
};

Eigen::VectorXd errors_at(const CameraSet& cameras,
                          const std::vector<Seen>& seen,
                          const Eigen::Vector3d& point) {
    Eigen::VectorXd errors(2 * static_cast<Eigen::Index>(seen.size()));
    for (std::size_t i = 0; i < seen.size(); ++i) {
        const auto& camera = cameras[seen[i].camera];
        const auto& lens = camera.intrinsics;
        errors.segment<2>(2 * static_cast<Eigen::Index>(i)) =
            lens.distort(lens.project(camera.camera_from_site * point)) - seen[i].px;
    }
    return errors;
}

// The least squared error of a point that these cameras see, by Gauss-Newton from their rays.
double least_squared_error(const CameraSet& cameras, const std::vector<Seen>& seen) {
    Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
    Eigen::Vector3d right = Eigen::Vector3d::Zero();
    for (const Seen& one : seen) {
        const auto& camera = cameras[one.camera];
        const auto linear = camera.intrinsics.undistort(one.px);
        if (!linear) return 1e6;
        const geometry::RigidTransform site_from_camera = camera.camera_from_site.inverse();
        const Eigen::Vector3d ray =
            (site_from_camera.rotation * camera.intrinsics.ray_camera(*linear)).normalized();
        const Eigen::Matrix3d across = Eigen::Matrix3d::Identity() - ray * ray.transpose();
        sum += across;
        right += across * site_from_camera.translation;
    }
    Eigen::Vector3d point = sum.ldlt().solve(right);
    for (int step = 0; step < 10; ++step) {
        const Eigen::VectorXd errors = errors_at(cameras, seen, point);
        Eigen::MatrixXd slopes(errors.size(), 3);
        for (int k = 0; k < 3; ++k)
            slopes.col(k) =
                (errors_at(cameras, seen, point + 1e-6 * Eigen::Vector3d::Unit(k)) - errors) / 1e-6;
        point -= (slopes.transpose() * slopes).ldlt().solve(slopes.transpose() * errors);
    }
    return errors_at(cameras, seen, point).squaredNorm();
}

struct TriangulationError {
    double rms_px = 0.0;  // of the distances in the picture
    std::size_t num = 0;
};

// Of all corners that two cameras or more saw at these instants, without one left out.
TriangulationError triangulation_error(const CameraSet& cameras,
                                       const BoardPoints& points,
                                       const auto& is_taken) {
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::vector<Seen>> corners;
    for (std::size_t c = 0; c < points.size(); ++c)
        for (const BoardCorner& corner : points[c].corners)
            if (is_taken(corner.instant))
                corners[{corner.instant, corner.corner}].push_back({c, corner.px});
    double sum = 0.0;
    TriangulationError result;
    for (const auto& [key, seen] : corners) {
        if (seen.size() < 2) continue;
        sum += least_squared_error(cameras, seen);
        result.num += seen.size();
    }
    result.rms_px = std::sqrt(sum / static_cast<double>(std::max<std::size_t>(1, result.num)));
    return result;
}

// Each fifth of the instants is held out in turn: cameras that never saw them, beside the stored
// ones, which the other program made from them.
TEST(RealBoards, AreBetterThanTheirStoredSolution) {
    const fs::path folder = fs::path(test::source_dir()) / "../shared/data/calibration/boards4";
    if (!fs::exists(folder))
        GTEST_SKIP() << test::skip::kNoSharedData << "../shared/data/calibration/boards4";
    Board board;
    board.columns = 4;
    board.rows = 5;
    board.square_m = 0.054;
    board.marker_m = 0.75 * board.square_m;
    board.dictionary = "DICT_4X4_1000";
    board.is_inverted = true;
    ThreadPool pool(2);
    const auto film = film_boards(folder, {board}, {}, pool);
    ASSERT_TRUE(film) << film.error().message;
    ASSERT_EQ(film->points.size(), 4U);
    const auto stored = config::load_rig(folder / "stored_solution.toml");
    ASSERT_TRUE(stored) << stored.error().message;
    for (std::size_t c = 0; c < 4; ++c) ASSERT_EQ(film->points[c].name, stored->cameras[c].name);
    const auto all = triangulation_error(stored->cameras, film->points, [](auto) { return true; });
    EXPECT_GT(all.num, 1500U);
    double own = 0.0, theirs = 0.0;
    const std::uint32_t num_folds = test::kSanitized ? 1 : 5;
    for (std::uint32_t fold = 0; fold < num_folds; ++fold) {
        const auto is_held_out = [&](std::uint32_t instant) { return instant % 5 == fold; };
        BoardPoints part = film->points;
        for (BoardCamera& camera : part)
            std::erase_if(camera.corners,
                          [&](const BoardCorner& corner) { return is_held_out(corner.instant); });
        BoardOptions how;
        how.lens = LensFreedom::kAllAndThird;
        how.num_threads = 2;
        const auto solution = solve_board({board}, part, how);
        ASSERT_TRUE(solution) << solution.error().message;
        const auto ours =
            triangulation_error(cameras_of(solution->rig.bundle), film->points, is_held_out);
        const auto other = triangulation_error(stored->cameras, film->points, is_held_out);
        std::printf("fold %u: %.3f px, stored %.3f px, of %zu corners\n",
                    fold,
                    ours.rms_px,
                    other.rms_px,
                    ours.num);
        own += ours.rms_px * ours.rms_px / 5.0;
        theirs += other.rms_px * other.rms_px / 5.0;
    }
    if (test::kSanitized) return;  // one fold says nothing of the mean
    std::printf("all folds: %.3f px, stored %.3f px (all instants %.3f px)\n",
                std::sqrt(own),
                std::sqrt(theirs),
                all.rms_px);
    EXPECT_LT(std::sqrt(own), 0.9 * std::sqrt(theirs));
}

}  // namespace
}  // namespace atrium::calibrate
