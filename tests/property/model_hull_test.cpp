#include "core/config/rig.hpp"
#include "core/geometry/aabb.hpp"
#include "core/geometry/triangle_mesh.hpp"
#include "simulation/room_renderer.hpp"
#include "site_node/hull/visual_hull.hpp"
#include "site_node/silhouette/silhouette.hpp"
#include "tests/support/source_dir.hpp"
#include "tests/unit/simulation/made_person.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <string>

// The hull of a person from a model file, from the true silhouettes of a rig.
namespace atrium {
namespace {

TEST(ModelHull, OfACentimetreBipedIsAsLargeAsAPerson) {
    const auto rig = config::load_rig(atrium::test::source_dir() + "/deploy/rigs/full_body.toml");
    ASSERT_TRUE(rig) << rig.error().message;
    const auto folder = std::filesystem::path(testing::TempDir()) / "atrium_model_hull";
    std::filesystem::create_directories(folder);
    simulation::made::PersonOptions person;
    person.names = simulation::made::Names::kBiped;
    person.units_per_m = 100.0;
    person.fbx_unit_scale = 1.0;
    person.is_mesh_turned = true;
    person.arms_hang = true;
    person.has_animation = false;
    simulation::made::write_fbx(folder / "person.fbx", person);
    simulation::RoomOptions options;
    options.model = folder / "person.fbx";
    auto renderer = simulation::RoomRenderer::create(rig->cameras, options);
    ASSERT_TRUE(renderer) << renderer.error().message;
    std::vector<hull::SilhouetteView> views;
    silhouette::SilhouetteScratch scratch;
    image::YuvImage picture;
    for (std::size_t c = 0; c < rig->cameras.size(); ++c) {
        image::Mask mask;
        renderer->render(0.0, c, simulation::Scene::kPerson, 0, picture, &mask);
        const geometry::CalibratedCamera& camera = rig->cameras[c];
        hull::SilhouetteView view{camera.intrinsics, camera.camera_from_site, {}, {}};
        std::vector<silhouette::SilhouettePolygon> polygons;
        silhouette::extract_silhouette(mask, camera.intrinsics, {}, scratch, polygons);
        for (auto& polygon : polygons) view.contours.push_back(std::move(polygon.vertices_px));
        views.push_back(std::move(view));
    }
    hull::HullScratch hull_scratch;
    const hull::VisualHull hull = hull::compute_visual_hull(views, {}, hull_scratch);
    ASSERT_EQ(hull.status, hull::HullStatus::kOk);
    const double litres = 1000.0 * geometry::volume_m3(hull.mesh);
    RecordProperty("litres", std::to_string(litres));
    EXPECT_GT(litres, 60.0);
    EXPECT_LT(litres, 120.0);
    geometry::Aabb box;
    for (const Eigen::Vector3d& p : hull.mesh.vertices) box.add(p);
    EXPECT_NEAR(box.size().z(), 1.80, 0.06);
    EXPECT_NEAR(box.min.z(), 0.0, 0.05);
    std::filesystem::remove_all(folder);
}

}  // namespace
}  // namespace atrium
