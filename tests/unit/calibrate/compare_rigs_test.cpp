// A new rig beside the old one of the same room.
#include "tools/calibrate/report/compare_rigs.hpp"

#include "swept_room.hpp"
#include "tools/calibrate/report/sweep_error.hpp"

#include <Eigen/Geometry>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

namespace atrium::calibrate {
namespace {

using calibrate_test::sweep;
using calibrate_test::SweepOptions;
using testing::ElementsAre;
using testing::IsEmpty;

constexpr double kDegree = std::numbers::pi / 180.0;

class Rooms : public testing::TestWithParam<std::uint32_t> {
protected:
    Rooms() : rng_(GetParam()) {
        SweepOptions options;
        options.seed = GetParam();
        options.num_instants = 0;
        old_.cameras = sweep(default_wand(), options).cameras;
        new_ = old_;
    }

    Eigen::Vector3d direction() {
        std::normal_distribution<double> any;
        return Eigen::Vector3d(any(rng_), any(rng_), any(rng_)).normalized();
    }

    // Moves a camera by a length and turns it by an angle, both about its own centre.
    void move(std::size_t camera, double metres, double degrees) {
        geometry::RigidTransform site_from_camera = new_.cameras[camera].camera_from_site.inverse();
        site_from_camera.translation += metres * direction();
        site_from_camera.rotation =
            Eigen::AngleAxisd(degrees * kDegree, direction()) * site_from_camera.rotation;
        new_.cameras[camera].camera_from_site = site_from_camera.inverse();
    }

    // What two calibrations of the same cameras differ by.
    void shake() {
        for (std::size_t c = 0; c < new_.cameras.size(); ++c) move(c, 0.001, 0.02);
    }

    // The new calibration knows nothing of the old one's frame.
    geometry::RigidTransform change_frame() {
        const geometry::RigidTransform new_from_old{
            Eigen::Quaterniond(Eigen::AngleAxisd(2.0, direction())), 4.0 * direction()};
        for (geometry::CalibratedCamera& camera : new_.cameras)
            camera.camera_from_site = camera.camera_from_site * new_from_old.inverse();
        return new_from_old;
    }

    std::mt19937 rng_;
    config::Rig old_, new_;
};

TEST_P(Rooms, NameTheOneCameraThatMoved) {
    shake();
    const std::size_t moved = rng_() % new_.cameras.size();
    move(moved, 0.012, 0.3);
    change_frame();
    const RigComparison compared = compare_rigs(old_, new_);
    ASSERT_EQ(compared.moves.size(), 8U);
    for (std::size_t c = 0; c < 8; ++c) {
        EXPECT_EQ(compared.moves[c].stays, c != moved) << c;
        EXPECT_NEAR(compared.moves[c].moved_m, c == moved ? 0.012 : 0.001, 0.003) << c;
        EXPECT_NEAR(compared.moves[c].turned_deg, c == moved ? 0.3 : 0.02, 0.06) << c;
    }
    EXPECT_TRUE(compared.shares_frame());
    EXPECT_NEAR(compared.length_ratio, 1.0, 0.002);
}

// No sweep tells a principal point from a turn.
TEST_P(Rooms, TakeNoOtherPrincipalPointForATurn) {
    for (geometry::CalibratedCamera& camera : new_.cameras) {
        const double off_px = 8.0;
        camera.intrinsics.cx += off_px;
        const geometry::RigidTransform new_from_old{
            Eigen::Quaterniond(Eigen::AngleAxisd(-std::atan(off_px / camera.intrinsics.fx),
                                                 Eigen::Vector3d::UnitY())),
            Eigen::Vector3d::Zero()};
        camera.camera_from_site = new_from_old * camera.camera_from_site;
    }
    const RigComparison compared = compare_rigs(old_, new_);
    EXPECT_EQ(compared.num_staying(), 8U);
    for (const CameraMove& move : compared.moves) EXPECT_LT(move.turned_deg, 0.1) << move.name;
}

TEST_P(Rooms, KeepTheFrameThoughThreeCamerasWereTakenDown) {
    for (const std::size_t camera : {0U, 3U, 6U}) move(camera, 0.8, 20.0);
    const geometry::RigidTransform new_from_old = change_frame();
    const RigComparison compared = compare_rigs(old_, new_);
    EXPECT_EQ(compared.num_staying(), 5U);
    EXPECT_LT((compared.old_from_new * new_from_old).translation.norm(), 1e-9);
    const config::Rig laid = in_frame_of_old(new_, compared);
    for (const std::size_t c : {1U, 2U, 4U, 5U, 7U}) {
        EXPECT_LT((laid.cameras[c].centre_site() - old_.cameras[c].centre_site()).norm(), 1e-9);
        EXPECT_LT(laid.cameras[c].camera_from_site.rotation.angularDistance(
                      old_.cameras[c].camera_from_site.rotation),
                  1e-9);
    }
}

TEST_P(Rooms, ShareNoFrameOnceMostCamerasMoved) {
    for (std::size_t camera = 0; camera < 5; ++camera) move(camera, 0.5, 10.0);
    change_frame();
    EXPECT_FALSE(compare_rigs(old_, new_).shares_frame());
}

TEST_P(Rooms, TellLengthsThatAreAllOffByOneFactor) {
    shake();
    move(2, 0.3, 5.0);
    for (geometry::CalibratedCamera& camera : new_.cameras)
        camera.camera_from_site.translation *= 1.03;
    change_frame();
    EXPECT_NEAR(compare_rigs(old_, new_).length_ratio, 1.03, 0.002);
}

TEST_P(Rooms, NameCamerasThatWereExchanged) {
    shake();
    const auto a = rng_() % 8;
    const auto b = (a + 1 + rng_() % 7) % 8;
    std::swap(new_.cameras[a].camera_from_site, new_.cameras[b].camera_from_site);
    change_frame();
    const RigComparison compared = compare_rigs(old_, new_);
    EXPECT_THAT(compared.exchanged,
                ElementsAre(testing::Pair("cam" + std::to_string(std::min(a, b)),
                                          "cam" + std::to_string(std::max(a, b)))));
    EXPECT_THAT(compare_rigs(old_, old_).exchanged, IsEmpty());
}

// Three of five stay.
TEST_P(Rooms, NameTwoOfFiveThatWereExchanged) {
    for (config::Rig* rig : {&old_, &new_}) rig->cameras.resize(5);
    shake();
    std::swap(new_.cameras[1].camera_from_site, new_.cameras[4].camera_from_site);
    change_frame();
    EXPECT_THAT(compare_rigs(old_, new_).exchanged, ElementsAre(testing::Pair("cam1", "cam4")));
}

INSTANTIATE_TEST_SUITE_P(Seeds, Rooms, testing::Range(1U, 41U));

TEST(Comparison, NamesCamerasOfOneRigOnly) {
    SweepOptions options;
    options.num_instants = 0;
    config::Rig old_rig, new_rig;
    old_rig.cameras = new_rig.cameras = sweep(default_wand(), options).cameras;
    old_rig.cameras.erase(old_rig.cameras.begin());
    new_rig.cameras.pop_back();
    const RigComparison compared = compare_rigs(old_rig, new_rig);
    EXPECT_THAT(compared.only_in_new, ElementsAre("cam0"));
    EXPECT_THAT(compared.only_in_old, ElementsAre("cam7"));
    EXPECT_EQ(compared.num_staying(), 6U);
    const RigComparison nothing = compare_rigs({}, new_rig);
    EXPECT_THAT(nothing.moves, IsEmpty());
    EXPECT_FALSE(nothing.shares_frame());
}

// Seen without faults, the true rig errs by the noise; triangulation takes 3 of 2 n unknowns.
TEST(SweepError, IsTheNoiseForTheTrueRigAndMoreForAnother) {
    SweepOptions options;
    options.outliers = options.missed = options.reflections = 0.0;
    options.has_labels = true;
    options.num_instants = 60;
    const calibrate_test::SweptRoom room = sweep(default_wand(), options);
    config::Rig truth;
    truth.cameras = room.cameras;
    Bundle seen;
    seen.wand = default_wand();
    seen.wands.resize(options.num_instants);
    double num_unknown = 0.0;
    for (const NominalCamera& camera : room.nominal) {
        seen.cameras.emplace_back();
        seen.cameras.back().name = camera.name;
    }
    for (std::uint32_t instant = 0; instant < options.num_instants; ++instant) {
        std::vector<int> num_seen(4, 0);
        for (std::uint32_t c = 0; c < room.points.size(); ++c)
            for (const LightPoint& point : room.points[c].points)
                if (point.instant == instant) {
                    seen.sightings.push_back({c, instant, *point.light, point.px, true});
                    ++num_seen[*point.light];
                }
        for (const int n : num_seen) num_unknown += n >= 2 ? 3.0 : 2.0 * n;
    }
    const double n = 2.0 * static_cast<double>(seen.sightings.size());
    const double expected = options.noise_px * std::sqrt((n - num_unknown) / n);
    EXPECT_NEAR(*sweep_error_px(seen, truth), expected, 0.05 * expected);
    const auto most = std::ranges::max_element(
        room.points, {}, [](const LightCamera& camera) { return camera.points.size(); });
    config::Rig turned = truth;
    auto& pose =
        turned.cameras[static_cast<std::size_t>(most - room.points.begin())].camera_from_site;
    pose =
        geometry::RigidTransform{
            Eigen::Quaterniond(Eigen::AngleAxisd(0.2 * kDegree, Eigen::Vector3d::UnitY())),
            Eigen::Vector3d::Zero()} *
        pose;
    EXPECT_GT(*sweep_error_px(seen, turned), 2.0 * expected);
    config::Rig strangers = truth;
    for (geometry::CalibratedCamera& camera : strangers.cameras) camera.name += "x";
    EXPECT_FALSE(sweep_error_px(seen, strangers));
}

}  // namespace
}  // namespace atrium::calibrate
