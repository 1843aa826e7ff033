#include "viewer/scene/scene_view.hpp"

#include "core/gl/offscreen_context.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <optional>
#include <thread>

namespace atrium::viewer {
namespace {

namespace fs = std::filesystem;

class SceneViewTest : public testing::Test {
protected:
    void SetUp() override {
        fs::create_directories(folder_);
        std::ofstream(folder_ / "tetra.obj") << "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\n"
                                                "f 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";
        auto context = gl::OffscreenContext::create(16, 16);
        ASSERT_TRUE(context) << context.error().message;
        context_.emplace(std::move(*context));
        auto renderer = renderer::SceneRenderer::create({.width = 96, .height = 72});
        ASSERT_TRUE(renderer) << renderer.error().message;
        renderer_.emplace(std::move(*renderer));
    }
    void TearDown() override {
        renderer_.reset();
        fs::remove_all(folder_);
    }

    static bus::SceneObject ball(std::uint32_t id) {
        bus::SceneObject object;
        object.object = id;
        object.shape = bus::Shape::kSphere;
        object.size_m = Eigen::Vector3d::Constant(0.2);
        object.mass_kg = 1.0;
        return object;
    }
    void update(SceneChanges changes) {
        view_.update(std::move(changes), SceneTimeline::Clock::now(), std::nullopt, *renderer_);
    }
    // Colour in the middle of a picture of the current scene.
    renderer::RenderedPicture draw() {
        renderer_->draw(
            renderer::ViewCamera{.position_m = {0.0, -3.0, 0.3}, .target_m = {0.2, 0.0, 0.2}});
        renderer::RenderedPicture picture;
        renderer_->read_pixels(picture);
        return picture;
    }

    const fs::path folder_ =
        fs::temp_directory_path() / ("atrium-scene-view-" + std::to_string(getpid()));
    std::optional<gl::OffscreenContext> context_;
    std::optional<renderer::SceneRenderer> renderer_;  // destroyed before its context
    SceneView view_{folder_};
};

TEST_F(SceneViewTest, ShowsThousandsOfObjectsOverSeveralPictures) {
    constexpr std::uint32_t kNum = 3000;
    SceneChanges changes;
    for (std::uint32_t id = 1; id <= kNum; ++id) changes.objects[id] = ball(id);
    update(std::move(changes));
    EXPECT_GT(renderer_->num_objects(), 0U);
    // objects removed while they wait are never drawn; objects appear in the order of their ids
    SceneChanges later;
    later.objects[kNum] = std::nullopt;
    later.objects[1] = std::nullopt;
    update(std::move(later));
    for (std::size_t before = 0; before != renderer_->num_objects();) {
        before = renderer_->num_objects();
        update({});
    }
    EXPECT_EQ(renderer_->num_objects(), kNum - 2);
    view_.clear();
    update({});
}

TEST_F(SceneViewTest, GivesObjectsTheirModelsOnceLoaded) {
    bus::SceneObject thing = ball(7);
    thing.shape = bus::Shape::kConvex;
    thing.model = "tetra.obj";
    thing.size_m = {0.02, 0.02, 0.02};
    SceneChanges changes;
    changes.objects[7] = thing;
    bus::Scenery scenery;
    scenery.name = "stage";
    scenery.model = "tetra.obj";
    scenery.world_from_model.translation = {0.0, 1.0, 0.0};
    changes.scenery["stage"] = scenery;
    update(std::move(changes));
    const renderer::RenderedPicture before = draw();
    // until the models are loaded, a box of 2 cm, and one of 1 m for the scenery
    while (draw().rgba == before.rgba) {
        update({});
        std::this_thread::yield();
    }
    EXPECT_EQ(renderer_->num_objects(), 1U);
    while (!view_.is_complete()) update({});
    const renderer::RenderedPicture complete = draw();
    update({});
    EXPECT_EQ(draw().rgba, complete.rgba);
}

TEST_F(SceneViewTest, IsIncompleteUntilItsFilesAreReadAndShown) {
    EXPECT_TRUE(view_.is_complete());
    bus::SceneObject thing = ball(7);
    thing.shape = bus::Shape::kConvex;
    thing.model = "tetra.obj";
    SceneChanges changes;
    changes.objects[7] = thing;
    update(std::move(changes));
    EXPECT_FALSE(view_.is_complete()) << "only an update takes what was read";
    while (!view_.is_complete()) {
        update({});
        std::this_thread::yield();
    }
    EXPECT_TRUE(view_.mesh_of(thing));
}

// The origin of a model is often at its foot or a corner.
TEST_F(SceneViewTest, PicksTheDrawnModelWhereverItsOriginIs) {
    bus::SceneObject thing = ball(7);
    thing.shape = bus::Shape::kConvex;
    thing.model = "tetra.obj";
    thing.size_m = {1.0, 1.0, 1.0};
    SceneChanges changes;
    changes.objects[7] = thing;
    bus::SceneState state;
    state.time = Timestamp{1'000'000'000'000};
    state.objects.resize(1);
    state.objects[0].object = 7;
    state.objects[0].world_from_object.translation = {2.0, 0.0, 0.0};
    changes.states.emplace_back(state, SceneTimeline::Clock::now());
    update(std::move(changes));
    const auto picked_from_above = [&](double x, double y) {
        return view_.pick({{x, y, 5.0}, {0.0, 0.0, -1.0}});
    };
    while (!view_.mesh_of(thing)) {
        update({});
        std::this_thread::yield();
    }
    const auto hit = picked_from_above(2.6, 0.2);
    ASSERT_TRUE(hit) << "outside of a box around the origin";
    EXPECT_EQ(hit->object, 7U);
    EXPECT_TRUE(hit->point_object.isApprox(Eigen::Vector3d(0.6, 0.2, 0.2), 1e-6));
    EXPECT_FALSE(picked_from_above(1.7, -0.3)) << "in a box around the origin";
}

// A ball at 2 m, behind a wall at 1 m: scenery, a fixed box or a movable one.
TEST_F(SceneViewTest, PicksNothingThatAWallHides) {
    const Ray ray{{0, 0, 1}, {1, 0, 0}};
    bus::SceneState state;
    state.time = Timestamp{1'000'000'000'000};
    state.objects.resize(2);
    state.objects[0].object = 7;
    state.objects[0].world_from_object.translation = {2.0, 0.0, 1.0};
    state.objects[1].object = 8;
    state.objects[1].world_from_object.translation = {1.0, 0.0, 1.0};
    bus::SceneObject wall = ball(8);
    wall.shape = bus::Shape::kBox;
    wall.size_m = {0.1, 2.0, 2.0};
    const auto show = [&](double wall_kg) {
        wall.mass_kg = wall_kg;
        SceneChanges changes;
        changes.objects[7] = ball(7);
        changes.objects[8] = wall;
        changes.states.emplace_back(state, SceneTimeline::Clock::now());
        update(std::move(changes));
    };
    show(3.0);
    ASSERT_TRUE(view_.pick(ray));
    EXPECT_EQ(view_.pick(ray)->object, 8U);
    EXPECT_TRUE(std::isinf(view_.free_m(ray))) << "it may move away";
    show(0.0);
    EXPECT_FALSE(view_.pick(ray));
    EXPECT_NEAR(view_.free_m(ray), 0.95, 1e-6);
    const auto fixed = view_.pick(ray, SceneView::Pickable::kAllButPlanes);
    ASSERT_TRUE(fixed);
    EXPECT_EQ(fixed->object, 8U);

    SceneChanges gone;
    gone.objects[8] = std::nullopt;
    bus::Scenery scenery;
    scenery.name = "wall";
    scenery.model = "tetra.obj";  // the corner at its origin, and its edges 1 m along the axes
    scenery.world_from_model.translation = {0.9, -0.2, 0.8};
    gone.scenery["wall"] = scenery;
    update(std::move(gone));
    while (!view_.is_complete()) {
        update({});
        std::this_thread::yield();
    }
    EXPECT_NEAR(view_.free_m(ray), 0.9, 1e-6);
    EXPECT_FALSE(view_.pick(ray));
    EXPECT_FALSE(view_.pick(ray, SceneView::Pickable::kAllButPlanes));
    const Ray above{{0, 0, 3}, {1, 0, -1}};
    EXPECT_TRUE(view_.pick({above.origin, above.direction.normalized()})) << "over the wall";
}

}  // namespace
}  // namespace atrium::viewer
