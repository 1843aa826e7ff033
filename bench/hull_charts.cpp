#include "bench/hull_scenes.hpp"
#include "site_node/hull/cones.hpp"
#include "site_node/hull/field_of_view.hpp"
#include "site_node/hull/pencils.hpp"
#include "site_node/hull/strip_chart.hpp"
#include "site_node/hull/strip_sweep.hpp"

#include <Eigen/Dense>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <set>
#include <vector>

// What the hull's stages make of one simulated person, as JSON: the data of docs/figures/hull_*.svg
// (hull_figures.py draws them).
namespace atrium::bench {
namespace {

using hull::Cones;
using hull::StripChart;
using nlohmann::json;

constexpr int kNumViews = 8;
constexpr int kSegments = 48;  // per view: few enough to be seen one by one

json list(const Eigen::Vector3d& p) { return {p.x(), p.y(), p.z()}; }
json list(const Eigen::Vector2d& p) { return {p.x(), p.y()}; }

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

// One hull's faces, strip by strip.
struct Faces {
    Cones cones;
    hull::Pencils pencils;
    std::map<std::uint32_t, hull::RunFaces> of_strip;
    std::map<hull::VertexKey, Eigen::Vector3d> position;

    const Eigen::Vector3d& at(const hull::RunFaces& faces, std::uint32_t v) const {
        return position.at(faces.vertices[v].key);
    }
};

Faces find_faces(const std::vector<hull::SilhouetteView>& views) {
    hull::HullScratch scratch;
    hull::compute_visual_hull(views, {}, scratch);
    Faces out;
    out.cones = hull::intersected_cones(scratch);
    SerialExecutor executor;
    hull::build_pencils(out.cones, executor, out.pencils);
    hull::StripSweep sweep;
    for (std::uint32_t s = 0; s < out.cones.strips.size(); ++s) {
        hull::RunFaces& faces = out.of_strip[s];
        sweep.run(out.cones, out.pencils, {s, 1}, 1'000'000, faces);
        for (const auto& vertex : faces.vertices) {
            if (vertex.is_owner) out.position[vertex.key] = vertex.position;
        }
    }
    return out;
}

// Chart coordinates: phi, u.
Eigen::Vector2d in_chart(const Cones& cones, std::uint32_t strip, const Eigen::Vector3d& p) {
    const Cones::Strip& s = cones.strips[strip];
    Eigen::Matrix<double, 3, 2> rays;
    rays << cones.ray[s.from], cones.ray[s.to];
    const Eigen::Vector2d w =
        rays.colPivHouseholderQr().solve(Eigen::Vector3d(p - cones.views[s.view].centre));
    const double depth = w.sum();
    return {depth == 0.0 ? 0.5 : w.y() / depth, 1.0 / std::max(depth, 1e-9)};
}

// Where the sector of `other` cuts the strip, by samples: independent of what the sweep looked at.
json cut_of(const Cones& cones, std::uint32_t strip, std::uint32_t other) {
    const Cones::Strip& s = cones.strips[strip];
    const Cones::Strip& o = cones.strips[other];
    const Eigen::Vector3d& normal = cones.normal[other];
    const Eigen::Vector3d from_other = cones.views[s.view].centre - cones.views[o.view].centre;
    Eigen::Matrix<double, 3, 2> rays;
    rays << cones.ray[o.from], cones.ray[o.to];
    const auto solver = rays.colPivHouseholderQr();
    constexpr int kSamples = 1000;
    json ends = json::array();
    Eigen::Vector2d last;
    bool was_inside = false;
    for (int i = 0; i <= kSamples; ++i) {
        const double phi = static_cast<double>(i) / kSamples;
        const Eigen::Vector3d ray = cones.ray[s.from] + phi * (cones.ray[s.to] - cones.ray[s.from]);
        const double u = -normal.dot(ray) / normal.dot(from_other);
        const Eigen::Vector3d p = from_other + ray / u;
        const Eigen::Vector2d w = solver.solve(p);
        const bool inside = u > 0.0 && w.x() >= 0.0 && w.y() >= 0.0;
        if (inside && !was_inside) ends.push_back({phi, u});
        if (!inside && was_inside) ends.push_back(list(last));
        last = {phi, u};
        was_inside = inside;
    }
    if (was_inside) ends.push_back(list(last));
    return ends;
}

// The other cameras that see background at a place of the strip.
json carving(const std::vector<hull::SilhouetteView>& views,
             const Cones& cones,
             std::uint32_t strip,
             double phi,
             double u) {
    const Cones::Strip& s = cones.strips[strip];
    const Eigen::Vector3d p = cones.origin + cones.views[s.view].centre +
                              (cones.ray[s.from] + phi * (cones.ray[s.to] - cones.ray[s.from])) / u;
    json out = json::array();
    for (std::size_t v = 0; v < views.size(); ++v) {
        const Eigen::Vector3d p_camera = views[v].camera_from_site * p;
        bool inside = false;
        if (p_camera.z() > 0.0) {
            for (const auto& contour : views[v].contours) {
                if (hull::contains(contour, views[v].intrinsics.project(p_camera)))
                    inside = !inside;
            }
        }
        const Eigen::Vector3d centre = views[v].camera_from_site.inverse().translation;
        const bool is_own = (centre - cones.origin - cones.views[s.view].centre).norm() < 1e-6;
        if (!inside && !is_own) out.push_back(v);
    }
    return out;
}

// Camera of a strip, as `views` counts them: the hull sorts its views.
std::size_t input_view(const std::vector<hull::SilhouetteView>& views,
                       const Cones& cones,
                       std::size_t view) {
    std::size_t best = 0;
    double least = 1e9;
    for (std::size_t v = 0; v < views.size(); ++v) {
        const Eigen::Vector3d centre = views[v].camera_from_site.inverse().translation;
        const double distance = (centre - cones.origin - cones.views[view].centre).norm();
        if (distance < least) best = v;
        least = std::min(least, distance);
    }
    return best;
}

json chart_of(const std::vector<hull::SilhouetteView>& views, Faces& all, std::uint32_t strip) {
    const Cones& cones = all.cones;
    StripChart chart;
    chart.start(cones, all.pencils, strip);
    chart.collect();
    std::set<std::uint32_t> visible;
    for (const std::uint32_t p : chart.visible_at_start()) visible.insert(chart.piece(p).strip);
    json events = json::array();
    for (const std::uint32_t e : chart.order()) {
        const StripChart::Event& event = chart.event(e);
        for (std::uint32_t j = 0; j < event.num_arriving; ++j) {
            const auto& piece = chart.piece(event.arriving[j]);
            if (piece.visibility == StripChart::Visibility::kVisible) visible.insert(piece.strip);
        }
        for (std::uint32_t j = 0; j < event.num_leaving; ++j) {
            const auto& piece = chart.piece(event.leaving[j]);
            if (piece.visibility == StripChart::Visibility::kVisible) visible.insert(piece.strip);
        }
        const std::uint32_t piece = event.num_arriving > 0 ? event.arriving[0] : event.leaving[0];
        events.push_back({{"phi", event.phi},
                          {"u", chart.u(piece, event.phi)},
                          {"view", input_view(views, cones, event.view)}});
    }
    json pieces = json::array();
    for (std::uint32_t other = 0; other < cones.strips.size(); ++other) {
        if (cones.strips[other].view == cones.strips[strip].view) continue;
        const json ends = cut_of(cones, strip, other);
        for (std::size_t i = 0; i + 1 < ends.size(); i += 2) {
            pieces.push_back({{"strip", other},
                              {"view", input_view(views, cones, cones.strips[other].view)},
                              {"visible", visible.contains(other)},
                              {"ends", {ends[i], ends[i + 1]}}});
        }
    }
    const hull::RunFaces& faces = all.of_strip[strip];
    json triangles = json::array();
    for (const auto& triangle : faces.triangles) {
        json corners = json::array();
        for (const std::uint32_t v : triangle)
            corners.push_back(list(in_chart(cones, strip, all.at(faces, v))));
        triangles.push_back(corners);
    }
    json edges = json::array();
    for (const auto& [a, b] : faces.edges) {
        edges.push_back({list(in_chart(cones, strip, all.at(faces, a))),
                         list(in_chart(cones, strip, all.at(faces, b)))});
    }
    // the cameras' verdicts along one place of the sweep
    constexpr double kSweepPhi = 0.55;
    std::vector<double> cuts;
    for (const json& piece : pieces) {
        const auto& e = piece["ends"];
        const double a = e[0][0];
        const double b = e[1][0];
        if (!piece["visible"] || kSweepPhi < a || kSweepPhi > b) continue;
        const double ua = e[0][1];
        const double ub = e[1][1];
        cuts.push_back(ua + (ub - ua) * (kSweepPhi - a) / (b - a));
    }
    std::sort(cuts.rbegin(), cuts.rend());
    json gaps = json::array();
    for (std::size_t i = 0; i <= cuts.size(); ++i) {
        const double above = i == 0 ? cuts.front() * 1.02 : cuts[i - 1];
        const double below = i == cuts.size() ? cuts.back() * 0.98 : cuts[i];
        gaps.push_back(
            {{"above", above},
             {"below", below},
             {"carving", carving(views, cones, strip, kSweepPhi, 0.5 * (above + below))}});
    }
    const Cones::Strip& s = cones.strips[strip];
    return {{"strip", strip},
            {"view", input_view(views, cones, s.view)},
            {"rays", {list(cones.ray[s.from]), list(cones.ray[s.to])}},
            {"pieces", pieces},
            {"events", events},
            {"triangles", triangles},
            {"edges", edges},
            {"sweep_phi", kSweepPhi},
            {"gaps", gaps}};
}

// A strip with as many events and faces as can still be read.
std::uint32_t choose_strip(Faces& all) {
    std::uint32_t best = 0;
    std::size_t most = 0;
    for (const auto& [strip, faces] : all.of_strip) {
        StripChart chart;
        chart.start(all.cones, all.pencils, strip);
        chart.collect();
        if (!chart.may_have_faces() || chart.order().size() > 24) continue;
        const std::size_t score = 2 * faces.triangles.size() + chart.order().size();
        if (score > most) best = strip;
        most = std::max(most, score);
    }
    return best;
}

// The faces around the first vertex of three cameras that is not at some face's needle-sharp end.
json corner_of(const std::vector<hull::SilhouetteView>& views, Faces& all) {
    for (const auto& [key, place] : all.position) {
        if ((key & (hull::kCentreBit | hull::kRayBit)) != 0) continue;
        json faces = json::array();
        double shortest = 1.0;
        for (const int shift : {40, 20, 0}) {
            const auto strip = static_cast<std::uint32_t>((key >> shift) & 0xfffff);
            const hull::RunFaces& of_strip = all.of_strip[strip];
            json edges = json::array();
            for (const auto& [a, b] : of_strip.edges) {
                const Eigen::Vector3d& from = all.at(of_strip, a);
                const Eigen::Vector3d& to = all.at(of_strip, b);
                if ((from - to).norm() < 1e-9) shortest = 0.0;
                if (of_strip.vertices[a].key == key || of_strip.vertices[b].key == key)
                    shortest = std::min(shortest, (from - to).norm());
                edges.push_back({{"from", list(from)},
                                 {"to", list(to)},
                                 {"from_key", of_strip.vertices[a].key},
                                 {"to_key", of_strip.vertices[b].key}});
            }
            faces.push_back({{"strip", strip},
                             {"view", input_view(views, all.cones, all.cones.strips[strip].view)},
                             {"normal", list(all.cones.normal[strip].normalized())},
                             {"edges", edges}});
        }
        if (shortest < 0.03) continue;
        return {{"vertex", list(place)}, {"key", key}, {"faces", faces}};
    }
    return nullptr;
}

// All edges of the hull, and which of them lie on viewing rays; components without any are apart.
json components_of(const std::vector<hull::SilhouetteView>& views) {
    hull::HullOptions options;
    options.keep_phantoms = true;
    hull::HullScratch scratch;
    const hull::VisualHull all = hull::compute_visual_hull(views, options, scratch);
    const auto& mesh = all.mesh;
    std::vector<std::size_t> root(mesh.vertices.size());
    for (std::size_t v = 0; v < root.size(); ++v) root[v] = v;
    const auto find = [&](std::size_t v) {
        while (root[v] != v) v = root[v];
        return v;
    };
    for (const auto& [a, b, c] : mesh.triangles) {
        root[find(a)] = find(b);
        root[find(b)] = find(c);
    }
    std::map<std::size_t, json> parts;
    for (const auto& triangle : mesh.triangles) {
        json corners = json::array();
        for (const std::uint32_t v : triangle) corners.push_back(list(mesh.vertices[v]));
        parts[find(triangle[0])].push_back(corners);
    }
    json out = json::array();
    for (const auto& [v, triangles] : parts) out.push_back(triangles);
    return out;
}

json pencil_of(const Faces& all, std::size_t i, std::size_t k) {
    const auto angles = [&](std::size_t own, std::size_t other) {
        const hull::PencilSide& side = all.pencils.side(own, other);
        json out = json::array();
        for (const std::uint32_t r : side.sorted) {
            const Eigen::Vector2d& a = side.across[r];
            out.push_back({{"angle", std::atan2(a.y(), a.x())}, {"rank", side.rank[r]}});
        }
        return out;
    };
    return {{"first", angles(i, k)}, {"second", angles(k, i)}};
}

// A silhouette of which the picture shows a part only.
json field_of(const std::vector<hull::SilhouetteView>& views) {
    hull::Outlines outlines;
    hull::OutlineScratch scratch;
    hull::OutlineCounts counts;
    hull::copy_canonical(views[1].contours, 0.01, scratch, outlines, counts);
    hull::orient_by_nesting(outlines);
    Eigen::AlignedBox2d box;
    for (const Eigen::Vector2d& p : outlines.points) box.extend(p);
    const Eigen::Vector2d size = box.sizes();
    const Eigen::Vector2d low = box.min() + Eigen::Vector2d(-0.3 * size.x(), 0.08 * size.y());
    const Eigen::Vector2d high = box.max() + Eigen::Vector2d(-0.12 * size.x(), -0.35 * size.y());
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

int main() {
    using namespace atrium::bench;
    const auto views = person_views(kNumViews, kSegments);
    Faces all = find_faces(views);
    const std::uint32_t strip = choose_strip(all);
    const json out{{"views", list_views(views)},
                   {"pencil", pencil_of(all, 0, 1)},
                   {"chart", chart_of(views, all, strip)},
                   {"corner", corner_of(views, all)},
                   {"components", components_of(views)},
                   {"field", field_of(views)}};
    std::puts(out.dump().c_str());
    return 0;
}
