// Shadows on floors at any height, on objects and on scenery.
#include "tests/unit/renderer/scene_renderer_fixture.hpp"
#include "viewer/renderer/backdrop/backdrop.hpp"

#include <gtest/gtest.h>

namespace atrium::renderer {
namespace {

using Eigen::Vector3d;

class ReceivedShadows : public SceneRendererTest {
protected:
    static ObjectLook at(ObjectLook look, const Vector3d& middle) {
        look.world_from_object.translation = middle;
        return look;
    }

    // How much darker the surface at `point` is with shadows than without: 1 for no shadow.
    double share_left(const Vector3d& point) {
        const ViewCamera camera{.position_m = point + Vector3d(0.3, -2.5, 2.0), .target_m = point};
        renderer_->set_shadows(false);
        draw(camera);
        const double lit = pixel_at(camera, point).sum();
        renderer_->set_shadows(true);
        draw(camera);
        return pixel_at(camera, point).sum() / lit;
    }

    // Where the light through `point` reaches this height.
    static Vector3d below(const Vector3d& point, double height_m) {
        const Vector3d light = light_world().cast<double>();
        return point - light * ((point.z() - height_m) / light.z());
    }

    const Vector3d high_{0.4, -0.3, 1.5};  // the middle of a plate that casts the shadow
    void set_plate() { renderer_->set_object(1, at({.size_m = {0.5, 0.5, 0.02}}, high_)); }
};

TEST_F(ReceivedShadows, FallOnFloorsAtAnyHeight) {
    set_plate();
    for (const double height_m : {-0.6, -0.1, 0.0, 0.2, 1.0}) {
        renderer_->set_object(
            2, at({.shape = ShapeKind::kPlane, .size_m = {8, 8, 0}}, {0, 0, height_m}));
        EXPECT_NEAR(share_left(below(high_, height_m)), 0.7, 0.02) << height_m;
        EXPECT_NEAR(share_left(below(high_, height_m) + Vector3d(0.5, 0, 0)), 1.0, 0.01);
    }
}

TEST_F(ReceivedShadows, FallOnTopsOfObjectsAndScenery) {
    set_plate();
    const ObjectLook table{.size_m = {2.0, 2.0, 0.1}};
    const Vector3d top = below(high_, 0.7);
    for (const bool is_scenery : {false, true}) {
        const ObjectLook placed = at(table, {0, 0, 0.65});
        if (is_scenery) {
            renderer_->remove_object(2);
            renderer_->set_scenery("table", {&placed, 1});
        } else {
            renderer_->set_object(2, placed);
        }
        EXPECT_NEAR(share_left(top), 0.7, 0.02) << is_scenery;
        EXPECT_NEAR(share_left(top + Vector3d(0.5, 0.0, 0.0)), 1.0, 0.01) << is_scenery;
    }
}

// The same place of the shadow map: the plate hangs below the table's top.
TEST_F(ReceivedShadows, DoNotRise) {
    set_plate();
    const Vector3d above = below(high_, 1.9);
    renderer_->set_object(2, at({.size_m = {2.0, 2.0, 0.1}}, {above.x(), above.y(), 1.85}));
    EXPECT_NEAR(share_left(above), 1.0, 0.01);
    renderer_->set_object(3, at({.shape = ShapeKind::kPlane, .size_m = {8, 8, 0}}, {0, 0, 2.4}));
    EXPECT_NEAR(share_left({0.0, 0.0, 2.4}), 1.0, 0.01);
}

// No surface casts a shadow on itself, however it is tilted.
TEST_F(ReceivedShadows, SparesWhatCastsThem) {
    for (int tilt_deg = 0; tilt_deg <= 60; tilt_deg += 5) {
        ObjectLook board{.size_m = {1.2, 1.0, 0.05}};
        const Eigen::Quaterniond tilted(
            Eigen::AngleAxisd(tilt_deg * std::numbers::pi / 180.0, Vector3d(0.8, 0.6, 0.0)));
        board.world_from_object = {tilted, {0.0, 0.0, 1.0}};
        renderer_->set_object(2, board);
        for (const double x : {-0.4, 0.0, 0.4})
            EXPECT_NEAR(share_left(board.world_from_object * Vector3d(x, 0.1, 0.025)), 1.0, 0.01)
                << tilt_deg << " degrees, " << x;
    }
}

TEST_F(ReceivedShadows, OfAPersonFallOnATable) {
    const synthetic::Sphere head{{0.0, 0.0, 1.6}, 0.25};
    renderer_->set_person("a", person_of({head}, {}));
    renderer_->set_object(2, at({.size_m = {2.5, 2.5, 0.1}}, {0, 0, 0.65}));
    EXPECT_NEAR(share_left(below(head.centre, 0.7)), 0.7, 0.03);
    EXPECT_NEAR(share_left(below(head.centre, 0.7) + Vector3d(0.5, 0, 0)), 1.0, 0.01);
    // a person who stands beside it and is lower does not darken it
    renderer_->set_site_pose("a", {Eigen::Quaterniond::Identity(), {0.0, 0.0, -1.4}});
    EXPECT_NEAR(share_left(below({0.0, 0.0, 0.2}, 0.7)), 1.0, 0.01);
}

}  // namespace
}  // namespace atrium::renderer
