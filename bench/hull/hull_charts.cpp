#include "bench/hull/hull_charts_strips.hpp"
#include "bench/hull/hull_scenes.hpp"
#include "core/geometry/triangle_mesh.hpp"
#include "site_node/hull/field_of_view.hpp"
#include "site_node/hull/outlines.hpp"

#include <cmath>
#include <cstdio>
#include <map>
#include <numeric>
#include <string>
#include <vector>

// Results of the hull's stages for one simulated person, as JSON: the data of
// docs/figures/hull_*.svg (hull_figures.py draws them).
namespace atrium::bench {
namespace {

using nlohmann::json;

constexpr int kNumViews = 8;
constexpr int kSegments = 48;  // per view: few enough to be seen one by one

json list_views(const std::vector<hull::SilhouetteView>& views) {
    json out = json::array();
    for (const hull::SilhouetteView& view : views) {
        json contours = json::array();
        json rays = json::array();
        const auto site_from_camera = view.camera_from_site.inverse();
        for (const auto& contour : view.contours) {
            json points = json::array();
            for (const Eigen::Vector2d& p : contour) {
                points.push_back(list(p));
                rays.push_back(list(
                    Eigen::Vector3d(site_from_camera.rotation * view.intrinsics.ray_camera(p))));
            }
            contours.push_back(points);
        }
        out.push_back({{"centre", list(site_from_camera.translation)},
                       {"contours", contours},
                       {"rays", rays}});
    }
    return out;
}

// The same as a file for visual_hull (docs/visual_hull.md): deploy/views/person.json.
json views_file(const std::vector<hull::SilhouetteView>& views) {
    json out = json::array();
    for (const hull::SilhouetteView& view : views) {
        json contours = json::array();
        for (const auto& contour : view.contours) {
            json points = json::array();
            for (const Eigen::Vector2d& p : contour) {
                points.push_back({std::round(1e3 * p.x()) / 1e3, std::round(1e3 * p.y()) / 1e3});
            }
            contours.push_back(points);
        }
        const geometry::PinholeCamera& camera = view.intrinsics;
        const Eigen::Matrix<double, 3, 3, Eigen::RowMajor> rotation =
            view.camera_from_site.rotation.toRotationMatrix();
        out.push_back({{"name", "cam" + std::to_string(out.size())},
                       {"width", camera.width},
                       {"height", camera.height},
                       {"fx", camera.fx},
                       {"fy", camera.fy},
                       {"cx", camera.cx},
                       {"cy", camera.cy},
                       {"rotation", std::vector<double>(rotation.data(), rotation.data() + 9)},
                       {"translation", list(view.camera_from_site.translation)},
                       {"contours", contours}});
    }
    return {{"views", out}};
}

// Triangles of the largest component without any viewing edge, at the first resolution at which the
// person has one.
json phantom_of() {
    hull::HullOptions options;
    options.keep_phantoms = true;
    for (int n = 40; n <= 400; n += 4) {
        const auto views = person_views(kNumViews, n);
        hull::HullScratch scratch;
        if (hull::compute_visual_hull(views, {}, scratch).num_phantoms_dropped == 0) continue;
        const hull::VisualHull all = hull::compute_visual_hull(views, options, scratch);
        std::vector<std::size_t> root(all.mesh.vertices.size());
        std::iota(root.begin(), root.end(), std::size_t{0});
        const auto find = [&](std::size_t v) {
            while (root[v] != v) v = root[v];
            return v;
        };
        for (const auto& [a, b, c] : all.mesh.triangles) {
            root[find(a)] = find(b);
            root[find(b)] = find(c);
        }
        std::map<std::size_t, geometry::TriangleMesh> parts;
        for (const auto& triangle : all.mesh.triangles) {
            geometry::TriangleMesh& part = parts[find(triangle[0])];
            part.vertices = all.mesh.vertices;
            part.triangles.push_back(triangle);
        }
        const geometry::TriangleMesh* largest = nullptr;
        for (const auto& [v, part] : parts) {
            const bool is_person = part.triangles.size() > 100;
            if (!is_person &&
                (largest == nullptr || geometry::volume_m3(part) > geometry::volume_m3(*largest)))
                largest = &part;
        }
        if (largest == nullptr) continue;
        json triangles = json::array();
        for (const auto& [a, b, c] : largest->triangles) {
            triangles.push_back({list(largest->vertices[a]),
                                 list(largest->vertices[b]),
                                 list(largest->vertices[c])});
        }
        return {{"segments_per_view", n},
                {"volume_m3", geometry::volume_m3(*largest)},
                {"triangles", triangles}};
    }
    return nullptr;
}

// A silhouette that the picture shows only in part.
json field_of(const std::vector<hull::SilhouetteView>& views) {
    hull::Outlines outlines;
    hull::OutlineScratch scratch;
    hull::OutlineCounts counts;
    hull::copy_canonical(views[1].contours, 0.01, scratch, outlines, counts);
    hull::orient_by_nesting(outlines);
    Eigen::AlignedBox2d box;
    for (const Eigen::Vector2d& p : outlines.points) box.extend(p);
    const Eigen::Vector2d size = box.sizes();
    const Eigen::Vector2d low = box.min() + Eigen::Vector2d(-0.25 * size.x(), 0.05 * size.y());
    const Eigen::Vector2d high = box.max() + Eigen::Vector2d(-0.14 * size.x(), -0.42 * size.y());
    const std::vector<Eigen::Vector2d> field{low, {high.x(), low.y()}, high, {low.x(), high.y()}};
    hull::FieldScratch field_scratch;
    hull::LabelledOutlines labelled;
    hull::cut_by_field(outlines, field, true, field_scratch, labelled);
    json segments = json::array();
    for (const auto& s : labelled.segments) {
        segments.push_back(
            {{"kind", static_cast<int>(s.kind)},
             {"ends", {list(labelled.points[s.from]), list(labelled.points[s.to])}}});
    }
    json contours = json::array();
    for (std::size_t c = 0; c < outlines.num_contours(); ++c) {
        json points = json::array();
        for (const Eigen::Vector2d& p : outlines.contour(c)) points.push_back(list(p));
        contours.push_back(points);
    }
    json border = json::array();
    for (const Eigen::Vector2d& p : field) border.push_back(list(p));
    return {{"contours", contours}, {"field", border}, {"segments", segments}};
}

}  // namespace
}  // namespace atrium::bench

int main(int argc, char**) {
    using namespace atrium::bench;
    const auto views = person_views(kNumViews, kSegments);
    if (argc > 1) {  // any argument: print the views themselves
        std::puts(views_file(views).dump().c_str());
        return 0;
    }
    Faces all = find_faces(views);
    const std::uint32_t strip = choose_strip(all);
    const nlohmann::json out{{"views", list_views(views)},
                             {"pencil", pencil_of(all, 0, 1)},
                             {"chart", chart_of(views, all, strip)},
                             {"corner", corner_of(views, all)},
                             {"phantom", phantom_of()},
                             {"field", field_of(views)}};
    std::puts(out.dump().c_str());
    return 0;
}
