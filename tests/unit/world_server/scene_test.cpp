#include "world_server/scene.hpp"

#include "world_server/scene_messages.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

namespace atrium::world_server {
namespace {

using testing::HasSubstr;

bus::SceneObject ball(std::uint32_t id, double x = 0.0) {
    bus::SceneObject object;
    object.object = id;
    object.name = "ball";
    object.shape = bus::Shape::kSphere;
    object.size_m.setConstant(0.2);
    object.mass_kg = 0.5;
    object.world_from_object.translation = {x, 0.0, 0.1};
    return object;
}

WorldServerConfig floor_and_ball() {
    WorldServerConfig config;
    config.max_objects = 4;
    WorldObject floor;
    floor.rigid.id = 1;
    floor.name = "floor";
    floor.rigid.shape = physics::ObjectShape::kPlane;
    config.objects = {floor, WorldObject{.name = "ball", .rigid = to_rigid(ball(2))}};
    return config;
}

bus::SceneCommand command(bus::CommandKind kind, std::uint32_t target = 0) {
    bus::SceneCommand c;
    c.sender = "test";
    c.kind = kind;
    c.target = target;
    return c;
}

class SceneCommands : public testing::Test {
protected:
    void SetUp() override {
        auto made = Scene::create(floor_and_ball());
        ASSERT_TRUE(made) << made.error().message;
        scene.emplace(std::move(*made));
    }
    Expected<std::vector<SceneChange>> add(const bus::SceneObject& object) {
        bus::SceneCommand c = command(bus::CommandKind::kAdd);
        c.object = object;
        return scene->apply(c);
    }
    std::optional<Scene> scene;
};

TEST_F(SceneCommands, AddAssignsAnIdIfTheSenderGivesNone) {
    const auto first = add(ball(0, 1.0));
    const auto second = add(ball(0, 2.0));
    ASSERT_TRUE(first && second);
    EXPECT_EQ(first->at(0).object.object, 1000U);
    EXPECT_EQ(second->at(0).object.object, 1001U);
    EXPECT_FALSE(first->at(0).is_gone);
    EXPECT_EQ(scene->objects().size(), 4U);
}

TEST_F(SceneCommands, AddRefusesDuplicatesInvalidObjectsAndAFullWorld) {
    EXPECT_THAT(add(ball(2)).error().message, HasSubstr("already exists"));
    bus::SceneObject bad = ball(9);
    bad.size_m.setConstant(std::numeric_limits<double>::quiet_NaN());
    EXPECT_FALSE(add(bad));
    bad = ball(9);
    bad.mass_kg = 4000.0;
    EXPECT_THAT(add(bad).error().message, HasSubstr("density"));
    bad = ball(9, 500.0);
    EXPECT_THAT(add(bad).error().message, HasSubstr("outside the world"));
    bad = ball(9);
    bad.name = "no spaces allowed";
    EXPECT_FALSE(add(bad));
    EXPECT_EQ(scene->objects().size(), 2U) << "a refused command changed the world";

    ASSERT_TRUE(add(ball(10, 1.0)));
    ASSERT_TRUE(add(ball(11, 2.0)));
    EXPECT_THAT(add(ball(12, 3.0)).error().message, HasSubstr("has 4 objects"));
}

TEST_F(SceneCommands, RemoveAcceptsMovableObjectsNotTheFloor) {
    const auto removed = scene->apply(command(bus::CommandKind::kRemove, 2));
    ASSERT_TRUE(removed);
    EXPECT_TRUE(removed->at(0).is_gone);
    EXPECT_EQ(removed->at(0).object.object, 2U);
    EXPECT_FALSE(scene->apply(command(bus::CommandKind::kRemove, 2))) << "twice";
    EXPECT_THAT(scene->apply(command(bus::CommandKind::kRemove, 1)).error().message,
                HasSubstr("fixed"));
}

TEST_F(SceneCommands, RefusedEditsSayTheCause) {
    bus::SceneEdit edit;
    edit.sender = "eve";
    edit.kind = bus::EditKind::kPlace;
    edit.target = 2;
    edit.revision = 3;  // of an edit before the world was loaded
    EXPECT_EQ(scene->edit(edit, {}).error().message, "the world was loaded again");
    bus::SceneEdit removal;
    removal.sender = "bob";
    removal.kind = bus::EditKind::kRemove;
    removal.target = 2;
    ASSERT_TRUE(scene->edit(removal, {}));
    EXPECT_THAT(scene->edit(edit, {}).error().message, testing::EndsWith(" was removed by bob"));
    edit.target = 77;
    EXPECT_EQ(scene->edit(edit, {}).error().message,
              "there is no object 77 any more: it was removed, or the world was loaded again");
}

TEST_F(SceneCommands, ARemovalByCommandHasANameToo) {
    bus::SceneCommand removal = command(bus::CommandKind::kRemove, 2);
    removal.sender = "carol";
    ASSERT_TRUE(scene->apply(removal));
    bus::SceneEdit edit;
    edit.kind = bus::EditKind::kPlace;
    edit.target = 2;
    EXPECT_THAT(scene->edit(edit, {}).error().message, testing::EndsWith(" was removed by carol"));
}

TEST_F(SceneCommands, PushIsBoundedByTheSpeedLimit) {
    bus::SceneCommand push = command(bus::CommandKind::kPush, 2);
    push.impulse_ns = {1.0, 0, 0};
    ASSERT_TRUE(scene->apply(push));
    scene->world().tick();
    bus::SceneState state;
    scene->get_state("w", {}, state);
    EXPECT_NEAR(state.objects.at(1).linear_velocity.x(), 2.0, 0.1);

    push.impulse_ns = {1e5, 0, 0};
    EXPECT_THAT(scene->apply(push).error().message, HasSubstr("at most 7.5"));
    push.impulse_ns.setConstant(std::numeric_limits<double>::quiet_NaN());
    EXPECT_FALSE(scene->apply(push));
    push.target = 1;
    push.impulse_ns = {1, 0, 0};
    EXPECT_FALSE(scene->apply(push)) << "the floor";
    push.target = 77;
    EXPECT_FALSE(scene->apply(push)) << "nobody";
}

TEST_F(SceneCommands, GrabMovesTheHeldObjectUntilItIsRemoved) {
    bus::SceneCommand grab = command(bus::CommandKind::kGrab, 2);
    grab.goal_world = {0, 0, 1};
    ASSERT_TRUE(scene->apply(grab));
    for (int i = 0; i < 100; ++i) scene->world().tick();
    bus::SceneState state;
    scene->get_state("w", {}, state);
    EXPECT_NEAR(state.objects.at(1).world_from_object.translation.z(), 1.0, 0.02);

    bus::SceneCommand move = command(bus::CommandKind::kMove, 2);
    move.goal_world = {0.5, 0, 1};
    ASSERT_TRUE(scene->apply(move));
    move.sender = "other";
    EXPECT_THAT(scene->apply(move).error().message, HasSubstr("does not hold"));
    for (int i = 0; i < 100; ++i) scene->world().tick();
    scene->get_state("w", {}, state);
    EXPECT_NEAR(state.objects.at(1).world_from_object.translation.x(), 0.5, 0.02);

    EXPECT_TRUE(scene->apply(command(bus::CommandKind::kRelease, 2)));
    EXPECT_TRUE(scene->apply(command(bus::CommandKind::kRelease, 2)))
        << "a second release must be accepted";
    EXPECT_EQ(scene->world().num_grabs(), 0U);
    ASSERT_TRUE(scene->apply(grab));
    scene->forget_sender("test");
    EXPECT_EQ(scene->world().num_grabs(), 0U);
    grab.target = 1;
    EXPECT_FALSE(scene->apply(grab)) << "the floor";
}

TEST_F(SceneCommands, ResetReturnsObjects) {
    bus::SceneCommand push = command(bus::CommandKind::kPush, 2);
    push.impulse_ns = {1.0, 0, 0};
    ASSERT_TRUE(scene->apply(push));
    for (int i = 0; i < 60; ++i) scene->world().tick();
    bus::SceneState state;
    scene->get_state("w", {}, state);
    ASSERT_GT(state.objects.at(1).world_from_object.translation.x(), 0.3);
    ASSERT_TRUE(scene->apply(command(bus::CommandKind::kReset)));
    scene->get_state("w", {}, state);
    EXPECT_NEAR(state.objects.at(1).world_from_object.translation.x(), 0.0, 1e-6);
}

}  // namespace
}  // namespace atrium::world_server
