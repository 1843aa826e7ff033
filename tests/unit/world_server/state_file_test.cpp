#include "world_server/state_file.hpp"

#include "core/base/fnv1a.hpp"
#include "world_server/scene_messages.hpp"
#include "world_server/state_saver.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <fstream>
#include <limits>
#include <random>

namespace atrium::world_server {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using Random = std::mt19937_64;

class Folder {
public:
    Folder() : path_(fs::temp_directory_path() / ("atrium-state-" + std::to_string(getpid()))) {
        fs::remove_all(path_);
        fs::create_directories(path_);
    }
    ~Folder() { fs::remove_all(path_); }
    fs::path operator/(const char* name) const { return path_ / name; }
    const fs::path& path() const { return path_; }

private:
    fs::path path_;
};

double number(Random& random, double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random);
}

bus::SceneObject random_object(Random& random, std::uint32_t id) {
    bus::SceneObject object;
    object.object = id;
    object.name = "thing-" + std::to_string(random() % 1000);
    object.shape = static_cast<bus::Shape>(random() % 4);
    object.size_m.setConstant(number(random, 0.05, 1));
    object.mass_kg = number(random, 0.01, 20);
    object.friction = number(random, 0, 1);
    object.restitution = number(random, 0, 1);
    for (double& c : object.colour) c = number(random, 0, 1);
    if (random() % 2 == 0) object.texture = "wood/oak.png";
    const Eigen::Vector3d axis(number(random, -1, 1), number(random, -1, 1), 0.1);
    object.world_from_object.rotation = Eigen::AngleAxisd(number(random, -3, 3), axis.normalized());
    for (double& x : object.world_from_object.translation) x = number(random, -5, 5);
    return object;
}

SavedWorld random_world(Random& random, std::size_t max_objects) {
    SavedWorld world;
    world.description = random();
    world.next_id = static_cast<std::uint32_t>(random());
    world.state.tick = random();
    std::uint32_t id = 0;
    for (std::size_t n = random() % (max_objects + 1); n > 0; --n) {
        physics::ObjectMotion motion;
        motion.id = id += 1 + static_cast<std::uint32_t>(random() % 100);
        for (float& x : motion.position_m) x = static_cast<float>(number(random, -10, 10));
        for (float& x : motion.linear_velocity) x = static_cast<float>(number(random, -5, 5));
        for (float& x : motion.angular_velocity) x = static_cast<float>(number(random, -9, 9));
        motion.rotation =
            Eigen::AngleAxisf(static_cast<float>(number(random, -3, 3)), Eigen::Vector3f::UnitY())
                .toRotationMatrix();
        motion.activation = 1 + static_cast<std::int32_t>(random() % 3);
        motion.idle_s = static_cast<float>(number(random, 0, 3));
        world.state.objects.push_back(motion);
    }
    for (std::size_t n = random() % 3; n > 0; --n) {
        physics::SoftState soft;
        soft.id = id += 1;
        for (std::size_t node = random() % 20; node > 0; --node) {
            soft.positions.push_back(Eigen::Vector3f::Random());
            soft.velocities.push_back(Eigen::Vector3f::Random());
        }
        world.state.soft.push_back(soft);
    }
    for (std::size_t n = random() % 4; n > 0; --n) {
        world.added.push_back(random_object(random, id += 1));
    }
    for (std::size_t n = random() % 4; n > 0; --n)
        world.edited.push_back(random_object(random, id += 1));
    if (random() % 2 == 0) world.loaded = "saved-room";
    world.world_file = random();
    return world;
}

TEST(StateCodec, RoundTripIsExact) {
    Random random(31);
    for (int round = 0; round < 200; ++round) {
        const SavedWorld world = random_world(random, 40);
        const auto bytes = encode(world);
        const auto back = decode(bytes);
        ASSERT_TRUE(back) << back.error().message;
        EXPECT_EQ(back->description, world.description);
        EXPECT_EQ(back->next_id, world.next_id);
        EXPECT_EQ(back->state, world.state);
        ASSERT_EQ(back->added.size(), world.added.size());
        for (std::size_t i = 0; i < world.added.size(); ++i) {
            EXPECT_EQ(back->added[i].name, world.added[i].name);
            EXPECT_EQ(back->added[i].texture, world.added[i].texture);
        }
        EXPECT_EQ(back->loaded, world.loaded);
        EXPECT_EQ(back->world_file, world.world_file);
        EXPECT_EQ(back->edited.size(), world.edited.size());
        EXPECT_EQ(encode(*back), bytes) << "a second encoding must have the same bits";
    }
}

// Version 1 had no edited objects and no loaded world, version 2 no hash of the world file.
TEST(StateCodec, ReadsFilesOfOlderVersions) {
    Random random(34);
    SavedWorld world = random_world(random, 6);
    world.edited.clear();
    world.loaded.clear();
    for (const auto& [version, num_missing] : {std::pair{2, 8}, {1, 16}}) {
        auto bytes = encode(world);
        bytes.resize(bytes.size() - static_cast<std::size_t>(num_missing));
        bytes[8] = static_cast<std::uint8_t>(version);
        const std::uint64_t size = bytes.size() - 28;
        const std::uint64_t hash = fnv1a<std::uint8_t>(std::span(bytes).subspan(28));
        for (std::size_t i = 0; i < 8; ++i) {
            bytes[12 + i] = static_cast<std::uint8_t>(size >> (8 * i));
            bytes[20 + i] = static_cast<std::uint8_t>(hash >> (8 * i));
        }
        const auto back = decode(bytes);
        ASSERT_TRUE(back) << back.error().message;
        EXPECT_EQ(back->state, world.state);
        EXPECT_EQ(back->added.size(), world.added.size());
        EXPECT_EQ(back->world_file, 0U);
    }
}

TEST(StateCodec, RefusesEveryTruncationAndEveryFlippedBit) {
    Random random(32);
    const auto bytes = encode(random_world(random, 6));
    for (std::size_t size = 0; size < bytes.size(); ++size) {
        EXPECT_FALSE(decode(std::span(bytes).first(size))) << size;
    }
    auto damaged = bytes;
    for (std::size_t bit = 0; bit < 8 * bytes.size(); ++bit) {
        damaged[bit / 8] ^= static_cast<std::uint8_t>(1U << bit % 8);
        EXPECT_FALSE(decode(damaged)) << "bit " << bit;
        damaged[bit / 8] = bytes[bit / 8];
    }
    damaged.push_back(0);
    EXPECT_FALSE(decode(damaged)) << "longer";
}

// The checksum detects accidents, but anybody can compute it. The decoder also checks the content.
TEST(StateCodec, RefusesInvalidContentWithAGoodChecksum) {
    Random random(33);
    SavedWorld good = random_world(random, 6);
    good.state.objects.resize(2);
    good.state.objects[0].id = 1;
    good.state.objects[1].id = 2;
    good.added = {random_object(random, 1000)};
    ASSERT_TRUE(decode(encode(good)));
    const auto refused = [&](const std::function<void(SavedWorld&)>& spoil) {
        SavedWorld bad = good;
        spoil(bad);
        return !decode(encode(bad));
    };
    const float nan = std::numeric_limits<float>::quiet_NaN();
    EXPECT_TRUE(refused([](SavedWorld& w) { w.state.objects[1].id = 1; }));
    EXPECT_TRUE(refused([&](SavedWorld& w) { w.state.objects[0].position_m.x() = nan; }));
    EXPECT_TRUE(refused([](SavedWorld& w) { w.state.objects[0].rotation *= 2; }));
    EXPECT_TRUE(refused([](SavedWorld& w) { w.state.objects[0].activation = 99; }));
    EXPECT_TRUE(refused([](SavedWorld& w) { w.added[0].name = "../x"; }));
    EXPECT_TRUE(refused([](SavedWorld& w) { w.added[0].model = "../../etc/passwd"; }));
    EXPECT_TRUE(refused([](SavedWorld& w) { w.added[0].shape = static_cast<bus::Shape>(77); }));
    EXPECT_TRUE(refused([](SavedWorld& w) { w.added[0].mass_kg = -1; }));
}

TEST(StateCodec, SurvivesAnyBytesAfterAGoodHeader) {
    Random random(34);
    const auto sound = encode(random_world(random, 5));
    int num_decoded = 0;
    for (int round = 0; round < 20'000; ++round) {
        auto bytes = sound;
        for (std::size_t n = 1 + random() % 4; n > 0; --n) {
            bytes[28 + random() % (bytes.size() - 28)] = static_cast<std::uint8_t>(random());
        }
        std::uint64_t hash = 14695981039346656037ULL;
        for (std::size_t i = 28; i < bytes.size(); ++i) hash = (hash ^ bytes[i]) * 1099511628211ULL;
        for (int i = 0; i < 8; ++i) bytes[20 + i] = static_cast<std::uint8_t>(hash >> (8 * i));
        if (const auto world = decode(bytes)) {
            ++num_decoded;
            for (const auto& motion : world->state.objects) ASSERT_TRUE(physics::is_valid(motion));
        }
    }
    EXPECT_GT(num_decoded, 100) << "the test's header must be valid";
}

TEST(StateFile, IsOldOrNewWheneverItsWriterIsKilled) {
    const Folder folder;
    const fs::path file = folder / "world.state";
    Random random(35);
    const auto make = [](std::uint8_t value) { return std::vector<std::uint8_t>(200'000, value); };
    ASSERT_TRUE(write_atomically(file, make(0)));
    for (int round = 0; round < 15; ++round) {
        const pid_t child = fork();
        ASSERT_GE(child, 0);
        if (child == 0) {
            for (std::uint8_t value = 1;; ++value) (void)write_atomically(file, make(value));
        }
        usleep(static_cast<useconds_t>(random() % 20'000));  // any moment will do
        kill(child, SIGKILL);
        waitpid(child, nullptr, 0);
        const auto bytes = read_file(file);
        ASSERT_TRUE(bytes) << bytes.error().message;
        ASSERT_EQ(bytes->size(), 200'000U);
        EXPECT_EQ(*bytes, make(bytes->front())) << "the file mixes two saves";
    }
}

TEST(StateFile, IsKeptAsideIfBad) {
    const Folder folder;
    const fs::path file = folder / "world.state";
    for (const char* text : {"first", "second"}) {
        std::ofstream(file) << text;
        const auto aside = put_aside(file);
        ASSERT_TRUE(aside) << aside.error().message;
        EXPECT_FALSE(fs::exists(file));
        std::string found;
        std::ifstream(*aside) >> found;
        EXPECT_EQ(found, text) << "one backup overwrote another";
    }
    EXPECT_FALSE(put_aside(file));
    EXPECT_EQ(read_file(file).error().kind, ErrorKind::kNotFound);
    EXPECT_FALSE(write_atomically(folder / "no" / "such" / "folder", {}));
}

WorldServerConfig floor_and_balls(const fs::path& file) {
    WorldServerConfig config;
    config.state_file = file;
    WorldObject floor;
    floor.rigid.id = 1;
    floor.name = "floor";
    floor.rigid.shape = physics::ObjectShape::kPlane;
    config.objects.push_back(floor);
    for (std::uint32_t id = 2; id < 5; ++id) {
        WorldObject ball;
        ball.rigid.id = id;
        ball.name = "ball-" + std::to_string(id);
        ball.rigid.shape = physics::ObjectShape::kSphere;
        ball.rigid.size_m.setConstant(0.2);
        ball.rigid.mass_kg = 0.5;
        ball.rigid.world_from_object.translation = {0.5 * id, 0.0, 0.5};
        config.objects.push_back(ball);
    }
    return config;
}

bus::SceneCommand state_command(bus::CommandKind kind, std::uint32_t target) {
    bus::SceneCommand c;
    c.sender = "test";
    c.kind = kind;
    c.target = target;
    return c;
}

TEST(SavedScene, ReturnsWithAddedAndWithoutRemovedObjects) {
    const Folder folder;
    const WorldServerConfig config = floor_and_balls(folder / "world.state");
    auto scene = Scene::create(config);
    ASSERT_TRUE(scene);
    ASSERT_TRUE(scene->apply(state_command(bus::CommandKind::kRemove, 3)));
    bus::SceneCommand add = state_command(bus::CommandKind::kAdd, 0);
    add.object = to_message(config.objects[1]);
    add.object.object = 0;
    add.object.name = "new";
    add.object.friction = 0.9;
    add.object.world_from_object.translation = {-1, 0, 1};
    ASSERT_TRUE(scene->apply(add));
    for (int i = 0; i < 100; ++i) scene->world().tick();
    SavedWorld saved;
    scene->save(saved);
    StateSaver saver(config.state_file);
    saver.save(saved);
    EXPECT_EQ(saver.num_saves(), 1U);

    auto loaded = load_scene(config);
    ASSERT_TRUE(loaded) << loaded.error().message;
    ASSERT_TRUE(*loaded);
    Scene& back = **loaded;
    EXPECT_EQ(back.world().state_hash(), scene->world().state_hash());
    ASSERT_EQ(back.objects().size(), 4U);
    EXPECT_EQ(back.objects()[3].name, "new");
    EXPECT_EQ(back.objects()[3].friction, 0.9);
    const auto again = back.apply(add);
    ASSERT_TRUE(again);
    EXPECT_EQ(again->at(0).object.object, 1001U) << "an id was assigned twice";
    EXPECT_TRUE(scene->apply(add));
    for (int i = 0; i < 100; ++i) {
        back.world().tick();
        scene->world().tick();
        ASSERT_EQ(back.world().state_hash(), scene->world().state_hash()) << i;
    }
}

TEST(SavedScene, ReturnsWithItsEdits) {
    const Folder folder;
    const WorldServerConfig config = floor_and_balls(folder / "world.state");
    auto scene = Scene::create(config);
    ASSERT_TRUE(scene);
    bus::SceneEdit change;
    change.sender = "eve";
    change.kind = bus::EditKind::kChange;
    change.target = 2;
    change.object = to_message(config.objects[1]);
    change.object.name = "heavy";
    change.object.size_m.setConstant(0.5);
    change.object.mass_kg = 9000.0;
    const auto refused = scene->edit(change, nullptr);
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().message.find("mass_kg must give a mass of 0.0655 to 1960 kg"), 0U)
        << refused.error().message;
    change.object.mass_kg = 12.5;
    ASSERT_TRUE(scene->edit(change, nullptr));
    bus::SceneEdit place = change;
    place.kind = bus::EditKind::kPlace;
    place.world_from_object.translation = {2, 1, 0.25};
    place.object.world_from_object = place.world_from_object;
    ASSERT_TRUE(scene->edit(place, nullptr));
    SavedWorld saved;
    scene->save(saved);
    StateSaver saver(config.state_file);
    ASSERT_TRUE(saver.save(saved));
    auto loaded = load_scene(config);
    ASSERT_TRUE(loaded) << loaded.error().message;
    ASSERT_TRUE(*loaded);
    Scene& back = **loaded;
    const bus::SceneObject object = back.objects()[1];
    EXPECT_EQ(object.name, "heavy");
    EXPECT_EQ(object.mass_kg, 12.5);
    EXPECT_EQ(back.world().state_hash(), scene->world().state_hash());
    for (Scene* each : {&back, &*scene}) {
        each->world().reset();
        EXPECT_EQ(each->world().pose_of(2)->translation.x(), 2.0) << "its start is the edited one";
    }
    // edits continue from the file, and a viewer's older revision no longer holds
    change.revision = 0;
    EXPECT_FALSE(back.edit(change, nullptr));
}

TEST(SavedScene, OfAnotherWorldIsRefusedAndKeptAside) {
    const Folder folder;
    WorldServerConfig config = floor_and_balls(folder / "world.state");
    auto scene = Scene::create(config);
    ASSERT_TRUE(scene);
    SavedWorld saved;
    scene->save(saved);
    StateSaver(config.state_file).save(saved);

    config.objects[2].rigid.size_m.setConstant(0.25);
    const auto other = load_scene(config);
    ASSERT_FALSE(other);
    EXPECT_THAT(other.error().message, HasSubstr("another description"));
    EXPECT_THAT(other.error().message, HasSubstr("world.state.bad-1"));
    EXPECT_FALSE(fs::exists(config.state_file));
    EXPECT_TRUE(fs::exists(config.state_file.string() + ".bad-1"));
    const auto none = load_scene(config);
    ASSERT_TRUE(none);
    EXPECT_FALSE(*none) << "no file must remain";
}

TEST(SavedScene, IsRefusedAsAWholeIfItNamesAMissingObject) {
    const Folder folder;
    const WorldServerConfig config = floor_and_balls(folder / "world.state");
    auto scene = Scene::create(config);
    ASSERT_TRUE(scene);
    SavedWorld saved;
    scene->save(saved);
    saved.state.objects.back().id = 40;
    EXPECT_FALSE(Scene::restore(config, saved));
    scene->save(saved);
    saved.added.push_back(to_message(config.objects[1]));  // id 2, which the description has
    EXPECT_FALSE(Scene::restore(config, saved));
    std::ofstream(config.state_file) << "this is no state";
    EXPECT_THAT(load_scene(config).error().message, HasSubstr("not a state file"));
}

}  // namespace
}  // namespace atrium::world_server
