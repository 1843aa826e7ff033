#include "viewer/control/scene_editor.hpp"

#include "core/bus/checks.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace atrium::viewer {
namespace {

using std::chrono::milliseconds;

const SceneEditor::Clock::time_point kStart{std::chrono::hours(1)};
const renderer::ViewCamera kEditorView{.position_m = {0, -3, 1.6}, .target_m = {0, 0, 1.6}};
const SceneEditor::Servers kServer{.are_there = true, .num_refused = 7};

bus::SceneObject named(const std::string& name) {
    bus::SceneObject object;
    object.name = name;
    return object;
}

TEST(NewObject, StandsInFrontOfTheEyeAboveTheFloor) {
    const renderer::EyeView eye = renderer::eye_of(kEditorView, 640, 360);
    NewObject wanted{.size_m = {0.4, 9, 9}, .name = "ball"};
    const bus::SceneObject ball = make_object(wanted, eye);
    EXPECT_TRUE(bus::check(ball));
    EXPECT_EQ(ball.size_m, Eigen::Vector3d(0.4, 0.4, 0.4));
    const Eigen::Vector3d& at = ball.world_from_object.translation;
    EXPECT_LT((at - Eigen::Vector3d(0, at.y(), 1.6)).norm(), 1e-9)
        << "the object must be where the eye looks";
    EXPECT_GT(at.y(), -1.6 - 1e-9);
    wanted.shape = bus::Shape::kBox;
    wanted.size_m = {0.2, 0.3, 1.0};
    const bus::SceneObject box = make_object(
        wanted, renderer::eye_of({.position_m = {0, 0, 1}, .target_m = {0, 0, 0}}, 640, 360));
    EXPECT_NEAR(box.world_from_object.translation.z(), 0.51, 1e-9)
        << "the object must lie on the floor when looking down";
}

TEST(NewObject, IsInThePictureAfterItHasFallen) {
    const NewObject wanted{.size_m = {0.3, 0.3, 0.3}, .name = "ball"};
    double before_m = 0.0;
    // less and less steeply down
    for (const double target_z_m : {-6.0, -2.0, 0.0, 0.8, 1.6}) {
        const renderer::ViewCamera camera{.position_m = {0, -3, 1.6},
                                          .target_m = {0, 0, target_z_m}};
        const renderer::EyeView eye = renderer::eye_of(camera, 640, 360);
        const auto at = make_object(wanted, eye).world_from_object.translation;
        const Eigen::Vector2d lying =
            renderer::project_px(camera, {at.x(), at.y(), 0.15}, 640, 360);
        EXPECT_GT(lying.y(), 0.0);
        EXPECT_LT(lying.y(), 340.0);
        NewObject tall = wanted;
        tall.shape = bus::Shape::kBox;
        tall.size_m = {0.4, 0.4, 1.0};
        const auto under = make_object(tall, eye).world_from_object.translation;
        const Eigen::Vector2d foot =
            renderer::project_px(camera, {under.x(), under.y(), 0.0}, 640, 360);
        EXPECT_LE(foot.y(), 324.5) << "its foot is in the picture too";
        const double away_m = (at - camera.position_m).head<2>().norm();
        EXPECT_GT(away_m, before_m) << "a flatter view must place the object farther away";
        before_m = away_m;
    }
    // looking at the sky: no place on the floor is in the picture
    const renderer::EyeView up =
        renderer::eye_of({.position_m = {0, -3, 1.6}, .target_m = {0, 0, 5}}, 640, 360);
    const auto at = make_object(wanted, up).world_from_object.translation;
    EXPECT_LT((at - up.eye_world()).norm(), 6.2);
}

TEST(NewObject, ComesBesideWhatIsThereButStaysInThePicture) {
    const renderer::EyeView eye = renderer::eye_of(kEditorView, 640, 360);
    const NewObject wanted{.size_m = {0.3, 0.3, 0.3}, .name = "ball"};
    const Eigen::Vector3d free = make_object(wanted, eye).world_from_object.translation;
    const auto place = [&](const std::vector<TakenPlace>& taken) -> Eigen::Vector3d {
        return make_object(wanted, eye, taken).world_from_object.translation;
    };
    EXPECT_EQ(place({{free.head<2>() + Eigen::Vector2d(0.0, 2.0), 0.3}}), free) << "behind it";
    const TakenPlace ball{free.head<2>(), 0.2};
    const double least_m = 0.2 + 0.5 * std::hypot(0.3, 0.3);
    const Eigen::Vector3d beside = place({ball});
    EXPECT_GE((beside - free).norm(), least_m);
    EXPECT_LT((beside - free).norm(), least_m + 0.11);
    const TakenPlace left{beside.head<2>(), 0.2};
    EXPECT_LT((place({ball, left}) - free).dot(beside - free), 0.0) << "on the other side";
    EXPECT_EQ(place({{free.head<2>(), 50.0}}), free) << "all is taken";
}

bus::SceneObject painted_beam() {
    bus::SceneObject beam = named("crate");
    beam.object = 3;
    beam.size_m = {1.2, 0.2, 0.1};
    beam.mass_kg = 0.0;
    beam.friction = 0.9;
    beam.restitution = 0.4;
    beam.colour = {0.1, 0.2, 0.3};
    beam.texture = "textures/wood.png";
    return beam;
}

TEST(NewObject, HasTheColourOfItsModel) {
    const renderer::EyeView eye = renderer::eye_of(kEditorView, 640, 360);
    NewModel pot;
    pot.file = "pots/pot.obj";
    EXPECT_EQ(make_object(pot, eye).colour, bus::SceneObject().colour);
    pot.colour = Eigen::Vector3d(0.8, 0.1, 0.2);
    EXPECT_EQ(make_object(pot, eye).colour, *pot.colour);
    EXPECT_EQ(make_object(pot, eye).name, "pot");
}

TEST(CopyOfAnObject, HasAllOfTheOriginalButNumberNameAndPlace) {
    const renderer::EyeView eye = renderer::eye_of(kEditorView, 640, 360);
    const bus::SceneObject beam = painted_beam();
    geometry::RigidTransform pose;
    pose.translation = {0.0, 1.0, 0.5};
    pose.rotation = Eigen::AngleAxisd(0.5 * EIGEN_PI, Eigen::Vector3d::UnitZ());
    const bus::SceneObject copy = make_copy(beam, pose, {{3, beam}}, eye, {});
    EXPECT_TRUE(bus::check(copy));
    EXPECT_EQ(copy.object, 0U);
    EXPECT_EQ(copy.name, "crate_2");
    EXPECT_EQ(copy.shape, beam.shape);
    EXPECT_EQ(copy.size_m, beam.size_m);
    EXPECT_EQ(copy.mass_kg, 0.0);
    EXPECT_EQ(copy.friction, 0.9);
    EXPECT_EQ(copy.restitution, 0.4);
    EXPECT_EQ(copy.colour, beam.colour);
    EXPECT_EQ(copy.texture, beam.texture);
    EXPECT_EQ(copy.world_from_object.rotation.coeffs(), pose.rotation.coeffs());
    const Eigen::Vector3d aside = copy.world_from_object.translation - pose.translation;
    EXPECT_NEAR(aside.z(), 0.0, 1e-9);
    EXPECT_GE(aside.norm(), std::hypot(1.2, 0.2)) << "neither touches the other";
    EXPECT_LT(aside.norm(), std::hypot(1.2, 0.2) + 0.11);
}

TEST(CopyOfAnObject, ComesBesideAnOriginalThatIsNotInThePicture) {
    const renderer::EyeView eye = renderer::eye_of(kEditorView, 640, 360);
    const bus::SceneObject beam = painted_beam();
    geometry::RigidTransform pose;
    pose.translation = {90.0, 1.0, 0.5};
    const auto at = make_copy(beam, pose, {}, eye, {}).world_from_object.translation;
    EXPECT_GE((at - pose.translation).norm(), std::hypot(1.2, 0.2));
    EXPECT_LT((at - pose.translation).norm(), 2.0);
}

TEST(CopyOfAnObject, HasTheNextFreeName) {
    const renderer::EyeView eye = renderer::eye_of(kEditorView, 640, 360);
    const auto name_of_copy = [&](const std::string& name, const std::vector<std::string>& others) {
        SceneEditor::Objects objects{{1, named(name)}};
        for (const std::string& other : others)
            objects[static_cast<std::uint32_t>(objects.size()) + 1] = named(other);
        return make_copy(named(name), {}, objects, eye, {}).name;
    };
    EXPECT_EQ(name_of_copy("crate", {"crate_2", "crate_3"}), "crate_4");
    EXPECT_EQ(name_of_copy("crate_2", {"crate"}), "crate_3") << "not crate_2_2";
    EXPECT_EQ(name_of_copy("fair_2024", {}), "fair_2024_2");
    EXPECT_EQ(name_of_copy("_7", {}), "_7_2") << "nothing would be left";
    EXPECT_EQ(name_of_copy(std::string(63, 'x'), {}), std::string(61, 'x') + "_2");
}

TEST(NewObject, IsValidForTheWorld) {
    const renderer::EyeView eye = renderer::eye_of(kEditorView, 640, 360);
    const bus::SceneObject capsule = make_object(
        {.shape = bus::Shape::kCapsule, .size_m = {0.3, 0.1, 0.2}, .name = "my capsule\n%s"}, eye);
    EXPECT_TRUE(bus::check(capsule));
    EXPECT_EQ(capsule.name, "my_capsule__s");
    EXPECT_EQ(capsule.size_m, Eigen::Vector3d(0.3, 0.3, 0.3))
        << "a capsule must not be lower than wide";
    const bus::SceneObject cylinder =
        make_object({.shape = bus::Shape::kCylinder, .size_m = {0.3, 0.1, 1e9}, .name = ""}, eye);
    EXPECT_TRUE(bus::check(cylinder));
    EXPECT_EQ(cylinder.name, "cylinder");
    EXPECT_EQ(cylinder.size_m, Eigen::Vector3d(0.3, 0.3, 4.0));
    EXPECT_TRUE(bus::check(make_object({.mass_kg = -1, .colour = {2, -1, 0}, .name = ""}, eye)));
}

TEST(SceneEditor, ReportsTheOutcomeOfEdits) {
    SceneEditor editor("me");
    SceneEditor::Objects objects{{3, named("ball")}};
    const bus::SceneCommand add = editor.add(named("ball"), objects, kStart);
    EXPECT_EQ(add.kind, bus::CommandKind::kAdd);
    EXPECT_EQ(add.sender, "me");
    EXPECT_EQ(add.object.object, 0U) << "the server must assign the id";
    editor.add(named("ball"), objects, kStart);
    EXPECT_TRUE(editor.outcomes(objects, kServer, kStart).empty())
        << "an existing object is no outcome";
    objects[1000] = named("ball");
    const auto first = editor.outcomes(objects, kServer, kStart + milliseconds(50));
    ASSERT_EQ(first.size(), 1U) << "the second object has not appeared";
    EXPECT_TRUE(first[0].is_done);
    EXPECT_EQ(first[0].text, "ball was added");
    objects[1001] = named("ball");
    EXPECT_EQ(editor.outcomes(objects, kServer, kStart + milliseconds(60)).size(), 1U);

    const bus::SceneCommand remove = editor.remove(3, objects, kStart);
    EXPECT_EQ(remove.kind, bus::CommandKind::kRemove);
    EXPECT_EQ(remove.target, 3U);
    EXPECT_TRUE(editor.outcomes(objects, kServer, kStart).empty());
    objects.erase(3);
    const auto gone = editor.outcomes(objects, kServer, kStart + milliseconds(70));
    ASSERT_EQ(gone.size(), 1U);
    EXPECT_EQ(gone[0].text, "ball was removed");
    EXPECT_TRUE(editor.outcomes(objects, kServer, kStart + milliseconds(9000)).empty());
}

TEST(SceneEditor, ReportsTheReasonOfAFailure) {
    SceneEditor editor("me");
    const SceneEditor::Objects objects{{3, named("floor")}};
    const auto after = [&](const SceneEditor::Servers& servers) {
        EXPECT_TRUE(editor.outcomes(objects, kServer, kStart).empty());
        editor.add(named("ball"), objects, kStart);
        EXPECT_TRUE(editor.outcomes(objects, servers, kStart + milliseconds(2400)).empty());
        const auto outcomes = editor.outcomes(objects, servers, kStart + milliseconds(2600));
        return outcomes.size() == 1 && !outcomes[0].is_done ? outcomes[0].text : "";
    };
    EXPECT_EQ(after({true, 8}), "ball was not added: the world server refused it");
    EXPECT_EQ(after(kServer), "ball was not added: the world server did not react");
    EXPECT_EQ(after({}), "ball was not added: no world server is running");
    editor.remove(3, objects, kStart);
    const auto kept = editor.outcomes(objects, {true, 9}, kStart + SceneEditor::kPatience);
    ASSERT_EQ(kept.size(), 1U);
    EXPECT_EQ(kept[0].text, "floor was not removed: the world server refused it");
}

TEST(SceneEditor, RemembersABoundedNumberOfEdits) {
    SceneEditor editor("me");
    for (int i = 0; i < 1000; ++i) editor.add(named("ball"), {}, kStart);
    EXPECT_LE(editor.outcomes({}, kServer, kStart + milliseconds(9000)).size(), 64U);
}

}  // namespace
}  // namespace atrium::viewer
