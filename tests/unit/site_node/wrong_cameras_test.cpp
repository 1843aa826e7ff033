// From the options of a simulated room to the verdict of a site: rendered pictures, the learned
// room, silhouettes, coherence. Only its threads and the bus are missing.
#include "simulation/wrong_cameras.hpp"

#include "simulation/room_config.hpp"
#include "site_node/coherence/coherence.hpp"
#include "site_node/silhouette_stage/silhouette_stage.hpp"
#include "site_node/simulated_room/simulated_source.hpp"
#include "tests/unit/simulation/rig_fixture.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <numbers>
#include <stop_token>
#include <string>
#include <vector>

namespace atrium::site_node {
namespace {

using coherence::Verdict;
using simulation::WrongCameras;
using testing::HasSubstr;

constexpr std::size_t kInstants = 30;  // of a loop

config::Rig room_rig() {
    config::Rig rig;
    rig.cameras = simulation::ring(6);
    rig.rate_hz = 240.0;  // nobody looks at the clock: a loop is over in an eighth of a second
    return rig;
}

simulation::RoomConfig small_room() {
    simulation::RoomConfig room;
    room.loop_s = kInstants / room_rig().rate_hz;
    room.motion = "stroll";
    room.bumped_turn_deg = 1.0;
    return room;
}

class WrongCamerasInASite : public testing::Test {
protected:
    static void SetUpTestSuite() {
        cache_ = std::filesystem::temp_directory_path() /
                 ("atrium-wrong-cameras-" + std::to_string(getpid()));
    }
    static void TearDownTestSuite() { std::filesystem::remove_all(cache_); }

    // What a site says of the rig after one loop.
    static coherence::Report judge(const simulation::RoomConfig& room) {
        const config::Rig rig = room_rig();
        const auto wrong = WrongCameras::create(room, rig.cameras);
        EXPECT_TRUE(wrong) << wrong.error().message;
        auto source = simulated_room::SimulatedSource::create(
            rig, simulation::room_options(room, rig.rate_hz), cache_, {}, {}, *wrong);
        EXPECT_TRUE(source) << source.error().message;
        auto stages = make_silhouette_stages(**source, all_cameras(**source), {}, {});
        std::vector<std::vector<coherence::SilhouetteHull>> seen(1);
        std::stop_source stop;
        const auto shown = (*source)->run(stop.get_token(), [&](const capture::CameraFrame& frame) {
            if (seen.size() > kInstants) return;
            PictureSilhouette found;
            EXPECT_TRUE(stages[frame.camera]);
            EXPECT_TRUE(stages[frame.camera]->find(frame, {}, found));
            seen.back().push_back(
                coherence::hull_of(found.contours, rig.cameras[frame.camera].intrinsics));
            if (seen.back().size() < rig.cameras.size()) return;
            if (seen.size() == kInstants) stop.request_stop();
            seen.emplace_back();
        });
        EXPECT_TRUE(shown);
        coherence::Coherence judge(rig.cameras);
        for (std::size_t i = 1; i < kInstants; ++i) judge.add({seen[i], seen[i - 1]});
        return judge.judge();
    }

    static inline std::filesystem::path cache_;
};

TEST_F(WrongCamerasInASite, AreNotFoundInATrueRig) {
    const coherence::Report report = judge(small_room());
    EXPECT_EQ(report.verdict, Verdict::kCoherent);
    EXPECT_LT(report.rms_px, 1.0);
}

TEST_F(WrongCamerasInASite, AreFoundIfOneWasBumped) {
    simulation::RoomConfig room = small_room();
    room.bumped_camera = "cam4";
    const coherence::Report report = judge(room);
    ASSERT_EQ(report.verdict, Verdict::kMoved);
    EXPECT_EQ(report.fault->camera, 4u);
    // so small pictures do not tell a turn from a motion, but where the camera sees the person
    const geometry::CalibratedCamera told = room_rig().cameras[4];
    const geometry::CalibratedCamera truth =
        simulation::bumped(told, std::numbers::pi / 180.0, 0.0);
    for (const double angle : {0.0, 2.0, 4.0}) {
        const Eigen::Vector3d waist(0.45 * std::cos(angle), 0.45 * std::sin(angle), 1.0);
        const auto px = [&](const geometry::RigidTransform& camera_from_site) {
            return truth.intrinsics.project(camera_from_site * waist);
        };
        const Eigen::Vector2d seen = px(truth.camera_from_site);
        EXPECT_GT((seen - px(told.camera_from_site)).norm(), 3.0);
        EXPECT_LT((seen - px(report.fault->camera_from_site)).norm(), 0.5);
    }
}

TEST_F(WrongCamerasInASite, AreFoundIfOneIsLate) {
    for (const int instants : {1, -1}) {
        simulation::RoomConfig room = small_room();
        room.late_camera = "cam1";
        room.late_instants = instants;
        const coherence::Report report = judge(room);
        ASSERT_EQ(report.verdict, Verdict::kLate) << instants;
        EXPECT_EQ(report.fault->camera, 1u);
        EXPECT_NEAR(report.fault->late_instants, instants, 0.15);
    }
}

TEST(WrongCameras, AreThoseThatTheOptionsName) {
    const auto rig = simulation::ring(3);
    simulation::RoomConfig room;
    room.bumped_camera = "cam7";
    EXPECT_THAT(WrongCameras::create(room, rig).error().message,
                HasSubstr("simulation.bumped_camera: the rig has no camera 'cam7': must be one of "
                          "cam0, cam1, cam2"));
    room.bumped_camera.clear();
    room.late_camera = "cam";
    EXPECT_THAT(WrongCameras::create(room, rig).error().message,
                HasSubstr("simulation.late_camera: the rig has no camera 'cam'"));
}

TEST(WrongCameras, ShowTheRigUntilTheBump) {
    const auto rig = simulation::ring(3);
    simulation::RoomConfig room;
    room.bumped_camera = "cam1";
    room.bumped_after_s = 10.0;
    const auto later = *WrongCameras::create(room, rig);
    ASSERT_EQ(later.rendered(rig).size(), 4u);
    EXPECT_EQ(later.rendered_index(1, 9.99), 1u);
    EXPECT_EQ(later.rendered_index(1, 10.0), 3u);
    EXPECT_EQ(later.rendered_index(2, 10.0), 2u);
    const auto centre = [](const geometry::CalibratedCamera& camera) {
        return camera.centre_site();
    };
    EXPECT_EQ(centre(later.rendered(rig)[1]), centre(rig[1]));
    room.bumped_after_s = 0.0;
    const auto at_once = *WrongCameras::create(room, rig);
    ASSERT_EQ(at_once.rendered(rig).size(), 3u);
    EXPECT_EQ(at_once.rendered_index(1, 0.0), 1u);
    EXPECT_EQ(at_once.rendered(rig)[1].camera_from_site.matrix(),
              later.rendered(rig)[3].camera_from_site.matrix());
}

TEST(WrongCameras, TurnAndMoveToTheRightOfTheirPictures) {
    const auto camera = simulation::ring(3)[1];
    const Eigen::Vector3d ahead = camera.camera_from_site.inverse() * Eigen::Vector3d(0, 0, 3.0);
    const auto turned = simulation::bumped(camera, 0.02, 0.0);
    EXPECT_LT((turned.centre_site() - camera.centre_site()).norm(), 1e-12);
    const Eigen::Vector3d seen = turned.camera_from_site * ahead;  // further left
    EXPECT_NEAR(std::atan2(seen.x(), seen.z()), -0.02, 1e-12);
    EXPECT_NEAR(seen.y(), 0.0, 1e-12);
    const auto moved = simulation::bumped(camera, 0.0, 0.05);
    EXPECT_TRUE((moved.camera_from_site * ahead).isApprox(Eigen::Vector3d(-0.05, 0.0, 3.0), 1e-12));
}

TEST(WrongCameras, ShowAnEarlierOrLaterInstantOfTheLoop) {
    const auto rig = simulation::ring(2);
    simulation::RoomConfig room;
    room.late_camera = "cam1";
    room.late_instants = 2;
    const auto late = *WrongCameras::create(room, rig);
    EXPECT_EQ(late.shown_instant(1, 5, 10), 3u);
    EXPECT_EQ(late.shown_instant(1, 1, 10), 9u);
    EXPECT_EQ(late.shown_instant(0, 1, 10), 1u);
    EXPECT_EQ(late.shown_instant(1, 0, 1), 0u);
    room.late_instants = -23;
    EXPECT_EQ(WrongCameras::create(room, rig)->shown_instant(1, 9, 10), 2u);
    EXPECT_EQ(WrongCameras{}.shown_instant(1, 9, 10), 9u);
}

}  // namespace
}  // namespace atrium::site_node
