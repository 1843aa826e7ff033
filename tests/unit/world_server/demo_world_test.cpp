// The demo's worlds with the demo's people, without cameras or network.
#include "simulation/person.hpp"
#include "tests/support/source_dir.hpp"
#include "tests/support/world/load_world.hpp"
#include "tools/demo/demo.hpp"
#include "world_server/config.hpp"
#include "world_server/physics/people/person_shape.hpp"
#include "world_server/scene.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <numbers>
#include <sstream>

namespace atrium::world_server {
namespace {

constexpr int kTicksPerMesh = 6;  // 20 Hz
const std::filesystem::path kSource = atrium::test::source_dir();

// Path of a file in deploy/demos.
Expected<demo::DemoConfig> load_demo(const std::string& name) {
    auto reader = config::TableReader::load(kSource / "deploy/demos" / (name + ".toml"));
    if (!reader) return tl::unexpected(reader.error());
    demo::DemoConfig config;
    config::OptionSet set;
    demo::declare(config, set);
    set.read_file(*reader);
    if (const auto read = reader->finish(); !read) return tl::unexpected(read.error());
    return config;
}

/// A world with alice and bob in it. Each repeats a motion every 3 s.
class Play {
public:
    Play(const WorldServerConfig& config, const std::vector<std::string>& motions)
        : config_(config), shapers_(2, physics::PersonShaper(config.person)) {
        auto scene = Scene::create(config);
        EXPECT_TRUE(scene);
        scene_.emplace(std::move(*scene));
        for (std::size_t i = 0; i < 2; ++i) {
            simulation::RoomOptions room;
            room.look = i == 0 ? "ada" : "ben";
            room.motion = motions.at(i);
            room.heading_rad = -std::numbers::pi / 2;  // faces +X of the site
            auto person = simulation::Person::create(room);
            EXPECT_TRUE(person);
            people_.push_back(std::move(*person));
        }
        for (std::size_t i = 0; i < config.objects.size(); ++i) {
            const WorldObject& object = config.objects[i];
            ids_[object.name] = object.rigid.id;
        }
    }

    void tick() {
        for (std::size_t i = 0; i < 2 && tick_ % kTicksPerMesh == 0; ++i) {
            geometry::TriangleMesh mesh = people_[i].mesh(std::fmod(tick_ / 120.0, 3.0));
            const NamedPlacement& placement = config_.placements.at(i);
            for (Eigen::Vector3d& v : mesh.vertices) v = placement.world_from_site * v;
            scene_->world().set_person(
                placement.site,
                shapers_[i].shape(mesh,
                                  Timestamp{1'000'000'000 + std::int64_t{8'333'333} * tick_}));
        }
        scene_->world().tick();
        ++tick_;
    }

    /// Position of the object of that name.
    Eigen::Vector3d place(const std::string& name) {
        bus::SceneState state;
        scene_->get_state("demo", Timestamp{}, state);
        for (const bus::ObjectState& object : state.objects) {
            if (object.object == ids_.at(name)) return object.world_from_object.translation;
        }
        ADD_FAILURE() << name << " is missing";
        return Eigen::Vector3d::Zero();
    }

    Scene& scene() { return *scene_; }

private:
    const WorldServerConfig& config_;
    std::optional<Scene> scene_;
    std::vector<simulation::Person> people_;
    std::vector<physics::PersonShaper> shapers_;
    std::map<std::string, std::uint32_t> ids_;
    int tick_ = 0;
};

class DemoWorld : public testing::Test {
protected:
    // The world of a file in deploy/demos, with the people's acts from that file.
    void open(const std::string& name) {
        const auto demo = load_demo(name);
        ASSERT_TRUE(demo) << demo.error().message;
        auto config = test_support::load_world(demo->world);
        ASSERT_TRUE(config) << config.error().message;
        config_ = std::move(*config);
        ASSERT_EQ(config_.placements.size(), 2U);
        std::vector<std::string> motions;
        std::istringstream list(demo->motions);
        for (std::string motion; std::getline(list, motion, ',');) motions.push_back(motion);
        ASSERT_EQ(motions.size(), 2U);
        play_.emplace(config_, motions);
    }
    void go_on(double seconds) {
        for (int tick = 0; tick < seconds * 120; ++tick) play_->tick();
    }

    WorldServerConfig config_;
    std::optional<Play> play_;
};

TEST_F(DemoWorld, HasObjectsThatPeoplePushToTheFloor) {
    const auto config = test_support::load_world(kSource / "deploy/worlds/demo.toml");
    ASSERT_TRUE(config) << config.error().message;
    ASSERT_EQ(config->placements.size(), 2U);
    Play play(*config, {"push", "wave"});
    for (int tick = 0; tick < 6 * 120; ++tick) play.tick();
    EXPECT_LT(play.place("red-ball").z(), 0.3) << "alice pushes it off the shelf";
    EXPECT_LT(play.place("blue-box").z(), 0.3) << "alice pushes it off the shelf";
    EXPECT_LT(play.place("green-ball").z(), 0.3) << "bob's waving hand hits it";
    EXPECT_GT(play.place("yellow-box").z(), 1.0) << "nobody touches it";
    const auto& counters = play.scene().world().counters();
    EXPECT_GT(counters.num_contact_ticks, 60U);
    EXPECT_EQ(counters.num_strays, 0U);
    EXPECT_EQ(counters.num_not_finite, 0U);
}

TEST_F(DemoWorld, HasABallPitThatBallsFlyOutOf) {
    open("ballpit");
    go_on(1.2);  // until the balls have fallen
    double highest_m = 0.0;
    bus::SceneState state;
    for (int i = 0; i < 24; ++i) {
        go_on(0.1);
        play_->scene().get_state("demo", Timestamp{}, state);
        for (const bus::ObjectState& object : state.objects)
            highest_m = std::max(highest_m, object.world_from_object.translation.z());
    }
    EXPECT_GT(highest_m, 0.7) << "more than twice the height of the walls";
}

TEST_F(DemoWorld, HasDominoesThatAliceTopples) {
    open("dominoes");
    go_on(6.0);
    EXPECT_LT(play_->place("ball").z(), 1.0) << "off its shelf, down the ramp";
    for (const WorldObject& object : config_.objects) {
        if (!object.name.starts_with("domino-")) continue;
        EXPECT_LT(play_->place(object.name).z(), 0.96) << object.name;
    }
}

TEST_F(DemoWorld, HasPuppetsThatAreCarriedAndSwung) {
    open("puppet");
    double highest_m = 0.0, furthest_m = 0.0;
    const Eigen::Vector3d hung = play_->place("marionette.chest");
    for (int i = 0; i < 60; ++i) {
        go_on(0.05);
        highest_m = std::max(highest_m, play_->place("pierrot.chest").z());
        furthest_m = std::max(furthest_m, (play_->place("marionette.chest") - hung).norm());
    }
    EXPECT_GT(highest_m, 1.15) << "lifted off the stand, whose top is at 1 m";
    EXPECT_GT(furthest_m, 0.08);
}

TEST_F(DemoWorld, HasACurtainThatAlicePartsWithHerHands) {
    open("curtain");
    const Eigen::Vector3d ball = play_->place("weight");
    go_on(1.9);  // both hands are apart, and alice stands between the panels
    std::vector<bus::SoftBodyState> states;
    play_->scene().get_soft_states(Timestamp{}, states);
    double left_m = 1.0, right_m = -1.0;  // inner edges of the panels at chest height
    for (std::size_t panel = 0; panel < 2; ++panel) {
        for (const auto& [x, y, z] : states.at(panel).nodes) {
            const bus::SoftBodyState& state = states[panel];
            const Eigen::Vector3d p = state.origin_m + state.step_m * Eigen::Vector3d(x, y, z);
            if (p.z() < 1.0 || p.z() > 1.4) continue;
            if (panel == 0) left_m = std::min(left_m, p.y());
            if (panel == 1) right_m = std::max(right_m, p.y());
        }
    }
    EXPECT_GT(left_m - right_m, 0.2) << "a gap that a person looks through";
    EXPECT_LT((play_->place("weight") - ball).norm(), 0.3) << "nobody touches it";
}

TEST_F(DemoWorld, HasABallToKickAndATowerToPushOver) {
    open("playroom");
    const Eigen::Vector3d ball = play_->place("football");
    go_on(3.0);
    EXPECT_GT((play_->place("football") - ball).norm(), 0.8);
    EXPECT_LT(play_->place("box-5").z(), 0.3) << "the hand met it, at 1.1 m";
    // box-6 falls to the floor, or onto the boxes that still stand
    EXPECT_LT(play_->place("box-6").z(), 1.2) << "it was the top of the tower, at 1.4 m";
}

}  // namespace
}  // namespace atrium::world_server
