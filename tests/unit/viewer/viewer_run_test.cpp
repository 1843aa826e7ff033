#include "tests/unit/viewer/viewer_run.hpp"

#include "core/bus/proxy_points.hpp"
#include "core/bus/soft_nodes.hpp"
#include "viewer/receive/proxy_inbox.hpp"
#include "viewer/renderer/drawing/view_camera.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/videoio.hpp>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <functional>
#include <optional>
#include <thread>

namespace atrium::viewer {
namespace {

TEST_F(ViewerRun, WarnsWithinTwoSecondsThatTheWorldServerIsLost) {
    testing::internal::CaptureStderr();
    start();
    {
        auto states = writer<bus::SceneState>();
        bus::SceneState state;
        state.world = "lost";
        ASSERT_TRUE(eventually([&] {
            state.time = Timestamp::now();
            EXPECT_TRUE(states.write(state));
            return states.num_readers() > 0 && viewer_->status().num_frames > 30;
        }));
    }
    // the writer has left, as after a kill or a cut
    const auto lost = std::chrono::steady_clock::now();
    EXPECT_TRUE(eventually([&] { return std::chrono::steady_clock::now() - lost > 2500ms; }));
    finish();
    const std::string log = testing::internal::GetCapturedStderr();
    const std::string event = "world_gone silent_s=";
    const auto at = log.find(event);
    ASSERT_NE(at, std::string::npos) << log;
    EXPECT_LT(std::stod(log.substr(at + event.size())), 2.0) << log;
}

TEST_F(ViewerRun, ShowsAPersonAndForgetsItWithItsSite) {
    start();
    {
        Site alice(*this);
        ASSERT_TRUE(show(alice, 3));
        EXPECT_GT(viewer_->status().capture_to_display.num_samples, 0u);
        finish();
        ASSERT_TRUE(result_) << result_.error().message;
        for (int i = 0; i < 3; ++i) EXPECT_NEAR(centre_of_output()[i], 230, 6);
        start();
        ASSERT_TRUE(show(alice, 1));
    }
    // the writers are gone: the last picture shows the empty room
    const auto frames = viewer_->status().num_frames;
    ASSERT_TRUE(eventually([&] { return viewer_->status().num_frames > frames + 60; }));
    finish();
    ASSERT_TRUE(result_) << result_.error().message;
    EXPECT_GT(std::abs(centre_of_output()[2] - 230), 10);
}

// The site stands away from the point at which a viewer looks in an empty world.
TEST_F(ViewerRun, FramesTheFirstPersonIfNoViewIsGiven) {
    config_.view.position_m.clear();
    config_.view.target_m.clear();
    config_.wait_people = 1;
    auto placements = writer<bus::SitePlacement>();
    bus::SitePlacement placement;
    placement.site = "alice";
    placement.world_from_site.rotation =
        Eigen::AngleAxisd(-1.5707963267948966, Eigen::Vector3d::UnitZ());
    placement.world_from_site.translation = {-4.0, 3.0, 0.0};
    ASSERT_TRUE(placements.write(placement));
    start();
    Site alice(*this);
    ASSERT_TRUE(show(alice, 3));
    finish();
    ASSERT_TRUE(result_) << result_.error().message;
    for (int i = 0; i < 3; ++i) EXPECT_NEAR(centre_of_output()[i], 230, 6);
}

TEST_F(ViewerRun, WritesNamesOverHeadsOnRequest) {
    config_.view.position_m = "6,0,1.2";
    config_.view.width = 640;
    config_.view.height = 360;
    Site alice(*this);
    std::vector<cv::Mat> pictures;
    for (const char* names : {"auto", "on"}) {
        config_.view.names = names;
        start();
        ASSERT_TRUE(show(alice, 3));
        finish();
        pictures.push_back(cv::imread(config_.output.string()));
    }
    cv::Mat difference;
    cv::absdiff(pictures[0], pictures[1], difference);
    EXPECT_GT(cv::norm(difference.rowRange(0, 180), cv::NORM_INF), 100)
        << "a run without a window must show no names";
    EXPECT_LT(cv::norm(difference.rowRange(180, 360), cv::NORM_INF), 20)
        << "only the part over the head may differ";
}

TEST_F(ViewerRun, ReadsAndDrawsProxiesOnlyForTheDebugView) {
    const std::vector<Eigen::Vector3f> places{{0, -0.3F, 0.9F}, {0, 0.3F, 1.5F}};
    const bus::Lattice lattice = bus::lattice_around(places);
    bus::PersonProxy proxy;
    proxy.site = "alice";
    proxy.origin_m = lattice.origin_m;
    proxy.step_m = lattice.step_m;
    // a sheet of surfels that move up fast: their lines cover the middle of the picture
    for (int i = 0; i < 2000; ++i) {
        const Eigen::Vector3f at(0, -0.3F + 3e-4F * static_cast<float>(i), 0.9F);
        proxy.points.push_back(bus::make_proxy_point(lattice, at, {0, 0, 6}, {1, 0, 0}));
    }
    auto proxies = writer<bus::PersonProxy>();
    const auto send_until_drawn = [&] {
        const auto frames = viewer_->status().num_frames;
        return eventually([&] {
            EXPECT_TRUE(proxies.write(proxy));
            return viewer_->status().num_frames > frames + 40;
        });
    };
    start();
    ASSERT_TRUE(send_until_drawn());
    EXPECT_EQ(proxies.num_readers(), 0);
    finish();
    const cv::Vec3b without = centre_of_output();
    config_.view.debug = "on";
    start();
    ASSERT_TRUE(eventually([&] { return proxies.num_readers() == 1; }));
    ASSERT_TRUE(send_until_drawn());
    EXPECT_EQ(viewer_->status().num_rejected, 0U);
    finish();
    ASSERT_TRUE(result_) << result_.error().message;
    const cv::Vec3b with = centre_of_output();
    EXPECT_GT(with[2], 2 * with[1]) << "a fast surfel must be red";
    EXPECT_GT(cv::norm(with, without), 60.0);
}

TEST_F(ViewerRun, ProxyInboxHasReadersOnlyWhileWanted) {
    auto people = writer<bus::PersonProxy>();
    auto objects = writer<bus::ObjectProxy>();
    bus::ObjectProxy chair;
    chair.object = 7;
    chair.vertices = {{0, 0, 0}, {1, 0, 0}};
    chair.edges = {{0, 1}};
    ASSERT_TRUE(objects.write(chair));  // before any reader exists
    ProxyInbox inbox;
    const auto has_taken = [&] {
        EXPECT_EQ(inbox.receive(*participant_).num_rejected, 0U);
        bus::PersonProxy alice;
        alice.site = "alice";
        EXPECT_TRUE(people.write(alice));
        const ProxyChanges changes = inbox.take();
        return changes.objects.contains(7) && changes.objects.at(7).has_value();
    };
    for (int round = 0; round < 2; ++round) {
        inbox.want(false);
        inbox.receive(*participant_);
        EXPECT_TRUE(eventually([&] { return people.num_readers() == 0; }));
        EXPECT_TRUE(inbox.take().people.empty());
        inbox.want(true);
        EXPECT_TRUE(eventually(has_taken)) << "objects must arrive again for a new reader";
        EXPECT_EQ(people.num_readers(), 1);
    }
    ASSERT_TRUE(objects.dispose(chair));
    EXPECT_TRUE(eventually([&] {
        inbox.receive(*participant_);
        const ProxyChanges changes = inbox.take();
        return changes.objects.contains(7) && !changes.objects.at(7);
    }));
}

// The site exists, but no longer sends anything.
TEST_F(ViewerRun, SlowPicturesAreNoSilenceOfASite) {
    config_.view.max_fps = 1.0;
    Site alice(*this);
    testing::internal::CaptureStderr();
    start();
    const bool is_shown = show(alice, 3);
    finish();
    const std::string log = testing::internal::GetCapturedStderr();
    EXPECT_TRUE(is_shown) << log;
    EXPECT_EQ(log.find("person_back"), std::string::npos) << log;
}

TEST_F(ViewerRun, PersonOfAStalledSiteFades) {
    start();
    Site alice(*this);
    ASSERT_TRUE(show(alice, 3));
    const auto frames = viewer_->status().num_frames;
    ASSERT_TRUE(eventually([&] { return viewer_->status().num_frames > frames + 60; }));
    finish();
    ASSERT_TRUE(result_) << result_.error().message;
    const cv::Vec3b stalled = centre_of_output();
    start();
    ASSERT_TRUE(eventually([&] { return viewer_->status().num_frames > 5; }));
    finish();
    const cv::Vec3b empty = centre_of_output();
    for (int i = 0; i < 3; ++i) EXPECT_NEAR(stalled[i], 0.35 * 230 + 0.65 * empty[i], 6);
    EXPECT_GT(cv::norm(stalled, empty), 10.0);
}

TEST_F(ViewerRun, ShowsObjectsAtTheirPlacesInTheWorld) {
    auto objects = writer<bus::SceneObject>();
    auto states = writer<bus::SceneState>();
    bus::SceneObject ball;
    ball.object = 3;
    ball.name = "ball";
    ball.shape = bus::Shape::kBox;
    ball.size_m = {0.4, 0.4, 0.4};
    ball.colour = {0.9, 0.0, 0.0};
    ball.world_from_object.translation = {0.0, 5.0, 0.0};
    ASSERT_TRUE(objects.write(ball));  // before the viewer starts
    start();
    std::uint64_t tick = 0;
    ASSERT_TRUE(eventually([&] {
        bus::SceneState state;
        state.world = "w";
        state.tick = ++tick;
        state.time = Timestamp::now();
        state.objects.resize(1);
        state.objects[0].object = 3;
        state.objects[0].world_from_object.translation = {0.0, 0.0, 1.2};
        EXPECT_TRUE(states.write(state));
        return viewer_->status().num_frames > 40;
    }));
    finish();
    ASSERT_TRUE(result_) << result_.error().message;
    EXPECT_GT(centre_of_output()[2], 2 * centre_of_output()[1]);
}

// A green cloth in front, and a piece of scenery that fills the picture behind it.
TEST_F(ViewerRun, ShowsSoftObjectsAndSceneryFromItsOwnFolder) {
    std::ofstream(folder_ / "wall.mtl") << "newmtl blue\nKd 0.05 0.05 0.9\n";
    std::ofstream(folder_ / "wall.obj")
        << "mtllib wall.mtl\nusemtl blue\n"
           "v 0 -5 -5\nv 0 5 -5\nv 0 5 6\nv 0 -5 6\nf 1 2 3\nf 1 3 4\n";
    config_.models = folder_;
    auto objects = writer<bus::SceneObject>();
    auto bodies = writer<bus::SoftBody>();
    auto soft_states = writer<bus::SoftBodyState>();
    auto states = writer<bus::SceneState>();
    auto sceneries = writer<bus::Scenery>();
    bus::Scenery wall;
    wall.name = "wall";
    wall.model = "wall.obj";
    wall.world_from_model.translation = {-2, 0, 0};
    ASSERT_TRUE(sceneries.write(wall));
    bus::SceneObject cloth;
    cloth.object = 4;
    cloth.name = "cloth";
    cloth.shape = bus::Shape::kSoft;
    cloth.colour = {0.0, 0.9, 0.0};
    ASSERT_TRUE(objects.write(cloth));
    ASSERT_TRUE(bodies.write({4, 4, 0.01, {{0, 1, 2}, {0, 2, 3}}, {}}));
    bus::SoftBodyState nodes;
    nodes.object = 4;
    bus::quantise(
        std::vector<Eigen::Vector3f>{
            {0, -0.3F, 0.9F}, {0, 0.3F, 0.9F}, {0, 0.3F, 1.5F}, {0, -0.3F, 1.5F}},
        nodes);
    start();
    ASSERT_TRUE(eventually([&] {
        bus::SceneState state;
        state.world = "w";
        state.tick = ++nodes.tick;
        state.time = nodes.time = Timestamp::now();
        EXPECT_TRUE(states.write(state));
        EXPECT_TRUE(soft_states.write(nodes));
        return viewer_->status().num_frames > 40;
    }));
    finish();
    ASSERT_TRUE(result_) << result_.error().message;
    EXPECT_GT(centre_of_output()[1], 2 * centre_of_output()[2]) << "the cloth";
    const cv::Mat picture = cv::imread(config_.output.string());
    for (const auto& [x, y] : {std::pair(40, 60), {280, 60}, {40, 150}}) {
        const cv::Vec3b colour = picture.at<cv::Vec3b>(y, x);
        EXPECT_GT(colour[0], 2 * colour[2]) << "the wall, where there would be sky or floor";
    }
}

}  // namespace
}  // namespace atrium::viewer
