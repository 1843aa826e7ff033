#include "core/bus/bus.hpp"
#include "site_node/site_node.hpp"
#include "tests/support/source_dir.hpp"
#include "viewer/renderer/drawing/view_camera.hpp"
#include "viewer/viewer.hpp"
#include "world_server/world_server.hpp"

#include <gtest/gtest.h>
#include <opencv2/imgcodecs.hpp>

#include <algorithm>
#include <filesystem>
#include <optional>
#include <thread>

// Two simulated rooms, a world server and a headless viewer in this process, over the real bus.
namespace atrium {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

// used by this test only: ctest may run others at the same time
constexpr std::uint32_t kDomain = 177;
constexpr std::uint32_t kBallOverTheHand = 1;
constexpr std::uint32_t kBallInTheOpen = 2;
const auto kPatience =
    std::chrono::seconds(120);  // for slow machines with sanitizers; usually some seconds

bus::BusOptions bus_options() {
    bus::BusOptions options;
    options.world = "two-sites-test";
    options.domain = kDomain;
    return options;
}

site_node::SiteNodeConfig site_config(const std::string& name, const std::string& look) {
    site_node::SiteNodeConfig config;
    config.name = name;
    config.capture.rig = atrium::test::source_dir() + "/deploy/rigs/full_body.toml";
    config.capture.rate_hz = 10.0;
    config.simulation.look = look;
    config.simulation.motion = "push";
    config.simulation.loop_s = 2.0;
    config.simulation.cache.clear();  // leaves no files
    config.bus = bus_options();
    return config;
}

world_server::WorldObject ball(std::uint32_t id, const Eigen::Vector3d& position_m) {
    world_server::WorldObject object;
    object.rigid.id = id;
    object.name = id == kBallOverTheHand ? "over_the_hand" : "in_the_open";
    object.rigid.shape = physics::ObjectShape::kSphere;
    object.rigid.size_m = Eigen::Vector3d::Constant(0.2);
    object.rigid.mass_kg = 0.3;
    object.rigid.world_from_object.translation = position_m;
    return object;
}

// Alice stands at x = -0.9 and reaches towards +x with her right hand. Bob stands opposite.
world_server::WorldServerConfig world_config() {
    world_server::WorldServerConfig config;
    config.bus = bus_options();
    world_server::WorldObject floor;
    floor.rigid.id = 3;
    floor.name = "floor";
    floor.rigid.shape = physics::ObjectShape::kPlane;
    floor.rigid.size_m = {6, 6, 1};
    config.objects = {
        ball(kBallOverTheHand, {-0.45, -0.17, 1.9}), ball(kBallInTheOpen, {0.0, 1.5, 1.9}), floor};
    world_server::NamedPlacement alice{"alice", {}};
    alice.world_from_site.translation = {-0.9, 0, 0};
    world_server::NamedPlacement bob{"bob", {}};
    bob.world_from_site.translation = {0.9, 0, 0};
    bob.world_from_site.rotation = Eigen::AngleAxisd(3.14159265358979, Eigen::Vector3d::UnitZ());
    config.placements = {alice, bob};
    return config;
}

viewer::ViewerConfig viewer_config(const fs::path& output) {
    viewer::ViewerConfig config;
    config.bus = bus_options();
    config.headless = true;
    config.view.context = "osmesa";  // it draws the rooms in this process
    config.view.width = 480;
    config.view.height = 270;
    config.view.position_m = viewer::ViewConfig::kUsualPosition;  // as `share_changed` expects
    config.output = output;
    return config;
}

cv::Mat picture_after(viewer::ViewerConfig config) {
    auto viewer = viewer::Viewer::create(config);
    EXPECT_TRUE(viewer) << (viewer ? "" : viewer.error().message);
    if (!viewer) return {};
    const auto done = (*viewer)->run({});
    EXPECT_TRUE(done) << (done ? "" : done.error().message);
    return cv::imread(config.output.string());
}

// Fraction of pixels that differ from the empty world where a person of 1.75 m at (x, 0) is
// expected.
double share_changed(const cv::Mat& empty, const cv::Mat& full, double x_m) {
    const auto camera = viewer::make_view_camera(viewer::ViewConfig{});
    int num_changed = 0;
    int num_pixels = 0;
    for (double z = 0.3; z < 1.6; z += 0.02) {
        for (double side = -0.12; side <= 0.12; side += 0.02) {
            const Eigen::Vector2d p =
                renderer::project_px(*camera, {x_m, side, z}, full.cols, full.rows);
            const cv::Vec3b a =
                empty.at<cv::Vec3b>(static_cast<int>(p.y()), static_cast<int>(p.x()));
            const cv::Vec3b b =
                full.at<cv::Vec3b>(static_cast<int>(p.y()), static_cast<int>(p.x()));
            num_changed += cv::norm(a, b, cv::NORM_L1) > 40;
            ++num_pixels;
        }
    }
    return static_cast<double>(num_changed) / num_pixels;
}

// Tracks of the two balls since the last reset.
struct BallTracks {
    double hand_sideways_m = 0.0;
    double open_sideways_m = 0.0;
};

class TwoSites : public testing::Test {
protected:
    void SetUp() override {
        auto world = world_server::WorldServer::create(world_config());
        ASSERT_TRUE(world) << world.error().message;
        world_ = std::move(*world);
        threads_.emplace_back([this](std::stop_token stop) { EXPECT_TRUE(world_->run(stop)); });
    }

    void start_sites() {
        for (const auto& [name, look] : {std::pair{"alice", "ada"}, std::pair{"bob", "ben"}}) {
            auto site = site_node::SiteNode::create(site_config(name, look), {});
            ASSERT_TRUE(site) << site.error().message;
            sites_.push_back(std::move(*site));
        }
        for (auto& site : sites_) {
            threads_.emplace_back([&site = *site](std::stop_token stop) {
                const auto done = site.run(stop);
                EXPECT_TRUE(done) << done.error().message;
            });
        }
    }

    void TearDown() override {
        for (auto& thread : threads_) thread.request_stop();
        threads_.clear();
    }

    std::unique_ptr<world_server::WorldServer> world_;
    std::vector<std::unique_ptr<site_node::SiteNode>> sites_;
    std::vector<std::jthread> threads_;
};

TEST_F(TwoSites, BothPeopleAppearAndAHandMovesABall) {
    const fs::path folder = fs::path(testing::TempDir()) / "atrium_two_sites";
    fs::create_directories(folder);
    auto before = viewer_config(folder / "empty.png");
    before.frames = 3;
    const cv::Mat empty = picture_after(before);
    ASSERT_FALSE(empty.empty());

    start_sites();
    if (HasFatalFailure()) return;
    auto during = viewer_config(folder / "full.png");
    during.frames = 20;
    during.wait_people = 2;
    during.wait_timeout_s = std::chrono::duration<double>(kPatience).count();
    const cv::Mat full = picture_after(during);
    ASSERT_FALSE(full.empty());
    EXPECT_GT(share_changed(empty, full, -0.9), 0.7) << "alice, see " << folder / "full.png";
    EXPECT_GT(share_changed(empty, full, 0.9), 0.7) << "bob, see " << folder / "full.png";

    // the balls fell before anybody was there: reset until the hand has met its ball
    auto participant = bus::Participant::create(bus_options());
    ASSERT_TRUE(participant);
    auto states = bus::Reader<bus::SceneState>::create(*participant);
    auto commands = bus::Writer<bus::SceneCommand>::create(*participant);
    auto waiter = bus::Waiter::create(*participant);
    ASSERT_TRUE(states && commands && waiter);
    waiter->add(*states);
    const auto give_up = Clock::now() + kPatience;
    std::uint64_t last_reset_tick = 0;
    BallTracks tracks;
    int num_resets = 0;
    while (tracks.hand_sideways_m < 0.1 && Clock::now() < give_up) {
        waiter->wait(std::chrono::milliseconds(500));
        states->take([&](bus::SceneState&& state) {
            if (state.tick >
                last_reset_tick + 360) {  // three seconds: longer than a fall and a push
                last_reset_tick = state.tick;
                tracks = {};
                bus::SceneCommand reset;
                reset.sender = "test";
                EXPECT_TRUE(commands->write(reset));
                ++num_resets;
                return;
            }
            for (const bus::ObjectState& object : state.objects) {
                const Eigen::Vector3d& p = object.world_from_object.translation;
                const Eigen::Vector2d start = object.object == kBallOverTheHand
                                                  ? Eigen::Vector2d(-0.45, -0.17)
                                                  : Eigen::Vector2d(0.0, 1.5);
                double& sideways = object.object == kBallOverTheHand ? tracks.hand_sideways_m
                                                                     : tracks.open_sideways_m;
                if (object.object != 3) sideways = std::max(sideways, (p.head<2>() - start).norm());
            }
        });
    }
    EXPECT_GE(tracks.hand_sideways_m, 0.1);
    // usually the first; the push repeats every 2 s, and a busy machine shifts it against the fall
    EXPECT_LE(num_resets, 4);
    EXPECT_LT(tracks.open_sideways_m, 0.02);  // nobody is near it: it falls straight
    EXPECT_GT(world_->status().num_contacts, 0u);

    for (const auto& site : sites_) {
        EXPECT_GT(site->status().num_metaframes_published, 0u);
        EXPECT_EQ(site->status().num_failed, 0u);
    }
    EXPECT_EQ(world_->status().num_rejected, 0u);
    fs::remove_all(folder);
}

}  // namespace
}  // namespace atrium
