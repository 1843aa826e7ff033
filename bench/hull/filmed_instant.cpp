#include "bench/hull/filmed_instant.hpp"

#include "site_node/silhouette/silhouette.hpp"
#include "tests/support/shapes/bounding_rect.hpp"

#include <fmt/format.h>

#include <cstddef>
#include <cstdlib>
#include <utility>

namespace atrium::bench {

std::vector<const hull::SilhouetteView*> FilmedInstant::silhouette_pointers() const {
    std::vector<const hull::SilhouetteView*> pointers;
    for (const hull::SilhouetteView& view : silhouettes) pointers.push_back(&view);
    return pointers;
}

std::vector<refine::PictureView> FilmedInstant::picture_views(
    std::span<const geometry::CalibratedCamera> cameras) const {
    std::vector<refine::PictureView> views;
    for (std::size_t i = 0; i < pictures.size(); ++i)
        views.push_back({&cameras[i], pictures[i], &masks[i], test::bounding_rect(masks[i])});
    return views;
}

FilmedInstant film(simulation::RoomRenderer& room, double time_s) {
    FilmedInstant instant;
    instant.pictures.resize(room.cameras().size());
    instant.masks.resize(room.cameras().size());
    silhouette::SilhouetteScratch scratch;
    std::vector<silhouette::SilhouettePolygon> polygons;
    for (std::size_t i = 0; i < room.cameras().size(); ++i) {
        const geometry::CalibratedCamera& camera = room.cameras()[i];
        image::Mask& mask = instant.masks[i];
        room.render(time_s, i, simulation::Scene::kPerson, 0, instant.pictures[i], &mask);
        silhouette::extract_silhouette(mask, camera.intrinsics, {}, scratch, polygons);
        hull::SilhouetteView view{camera.intrinsics, camera.camera_from_site, {}, {}};
        for (const auto& polygon : polygons) view.contours.push_back(polygon.vertices_px);
        instant.silhouettes.push_back(std::move(view));
    }
    return instant;
}

geometry::TriangleMesh hull_of(const FilmedInstant& instant,
                               hull::HullScratch& scratch,
                               const std::string& where) {
    hull::VisualHull hull = hull::compute_visual_hull(instant.silhouettes, {}, scratch);
    if (hull.status != hull::HullStatus::kOk) {
        fmt::print(stderr, "{}: no hull: {}\n", where, hull::to_string(hull.status));
        std::exit(1);
    }
    return std::move(hull.mesh);
}

}  // namespace atrium::bench
