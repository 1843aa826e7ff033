#include "bench/hull/hull_charts_strips.hpp"

#include "site_node/hull/outlines.hpp"
#include "site_node/hull/strip_chart.hpp"

#include <Eigen/Dense>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <set>
#include <utility>

namespace atrium::bench {
namespace {

using hull::Cones;
using hull::StripChart;
using nlohmann::json;

constexpr std::uint64_t kMaxSteps = 1'000'000;  // of a strip: more than any strip of a person needs

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

// Where the sector of `other` cuts the strip, by sampling: independent of the sweep.
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

// The other cameras that see background at a place on the strip.
json carving(const std::vector<hull::SilhouetteView>& views,
             const Cones& cones,
             std::uint32_t strip,
             double phi,
             double u) {
    const Cones::Strip& s = cones.strips[strip];
    const Eigen::Vector3d p =
        cones.to_site(cones.views[s.view].centre +
                      (cones.ray[s.from] + phi * (cones.ray[s.to] - cones.ray[s.from])) / u);
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
        const bool is_own = (centre - cones.to_site(cones.views[s.view].centre)).norm() < 1e-6;
        if (!inside && !is_own) out.push_back(v);
    }
    return out;
}

// Otherwise the figures would contradict the program.
void require(bool agrees, const char* what) {
    if (agrees) return;
    std::fprintf(stderr, "hull_charts: %s\n", what);
    std::exit(1);
}

// The sweep's state at one place: the gaps between the visible lines, counted from the camera, each
// with the cameras that carve it. Passing a line changes the bit of its camera. Hidden lines count
// as passed before all others or after them.
json gaps_at(double phi,
             const json& pieces,
             const json& carving_at_camera,
             const StripChart::Range& limits) {
    std::set<std::size_t> carving(carving_at_camera.begin(), carving_at_camera.end());
    const auto pass = [&](std::size_t view) {
        if (carving.erase(view) == 0) carving.insert(view);
    };
    std::vector<std::pair<double, std::size_t>> lines;  // u, view
    for (const json& piece : pieces) {
        const auto& e = piece["ends"];
        const double a = e[0][0];
        const double b = e[1][0];
        if (phi < a || phi > b) continue;
        const double ua = e[0][1];
        const double ub = e[1][1];
        const double u = ua + (ub - ua) * (phi - a) / (b - a);
        if (piece["visible"])
            lines.emplace_back(u, piece["view"]);
        else if (u > limits.high)
            pass(piece["view"]);
    }
    std::sort(lines.rbegin(), lines.rend());
    json gaps = json::array();
    for (std::size_t i = 0; i <= lines.size(); ++i) {
        if (i > 0) pass(lines[i - 1].second);
        gaps.push_back({{"above", i == 0 ? lines.front().first * 1.02 : lines[i - 1].first},
                        {"below", i == lines.size() ? lines.back().first * 0.98 : lines[i].first},
                        {"carving", carving}});
    }
    return gaps;
}

// Camera of a strip, numbered as in `views`: the hull sorts its views.
std::size_t input_view(const std::vector<hull::SilhouetteView>& views,
                       const Cones& cones,
                       std::size_t view) {
    std::size_t best = 0;
    double least = 1e9;
    for (std::size_t v = 0; v < views.size(); ++v) {
        const Eigen::Vector3d centre = views[v].camera_from_site.inverse().translation;
        const double distance = (centre - cones.to_site(cones.views[view].centre)).norm();
        if (distance < least) best = v;
        least = std::min(least, distance);
    }
    return best;
}

}  // namespace

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
        sweep.run(out.cones, out.pencils, {s, 1}, kMaxSteps, faces);
        for (const auto& vertex : faces.vertices) {
            if (vertex.is_owner) out.position[vertex.key] = vertex.position;
        }
    }
    return out;
}

std::uint32_t choose_strip(Faces& all) {
    std::uint32_t best = 0;
    std::size_t most = 0;
    for (const auto& [strip, faces] : all.of_strip) {
        StripChart chart;
        chart.start(all.cones, all.pencils, strip, kMaxSteps);
        chart.collect();
        if (!chart.may_have_faces() || chart.order().size() > 24) continue;
        const std::size_t score = 2 * faces.triangles.size() + chart.order().size();
        if (score > most) best = strip;
        most = std::max(most, score);
    }
    return best;
}

json chart_of(const std::vector<hull::SilhouetteView>& views, Faces& all, std::uint32_t strip) {
    const Cones& cones = all.cones;
    StripChart chart;
    chart.start(cones, all.pencils, strip, kMaxSteps);
    chart.collect();
    std::set<std::uint32_t> visible;
    for (const std::uint32_t p : chart.visible_at_start()) visible.insert(chart.piece(p).strip);
    json events = json::array();
    for (const std::uint32_t e : chart.order()) {
        const StripChart::Event& event = chart.event(e);
        for (std::uint32_t j = 0; j < event.num_arriving; ++j)
            visible.insert(chart.piece(event.arriving[j]).strip);
        for (std::uint32_t j = 0; j < event.num_leaving; ++j)
            visible.insert(chart.piece(event.leaving[j]).strip);
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
    constexpr double kSweepPhi = 0.55;
    constexpr double kAtCamera = 1e9;  // u
    const json carving_at_camera = carving(views, cones, strip, kSweepPhi, kAtCamera);
    const StripChart::Range& limits = chart.limits();
    for (const json& piece : pieces) {
        const double u0 = piece["ends"][0][1];
        const double u1 = piece["ends"][1][1];
        const bool outside = std::min(u0, u1) > limits.high || std::max(u0, u1) < limits.low;
        require(outside != piece["visible"].get<bool>(), "a piece is hidden between the limits");
    }
    const json gaps = gaps_at(kSweepPhi, pieces, carving_at_camera, limits);
    for (const json& gap : gaps) {
        const double u = 0.5 * (gap["above"].get<double>() + gap["below"].get<double>());
        require(u > limits.high || u < limits.low ||
                    gap["carving"] == carving(views, cones, strip, kSweepPhi, u),
                "the state between the limits is not what the cameras see");
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
            {"limits", {limits.low, limits.high}},
            {"gaps", gaps}};
}

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
    json strips = json::array();  // of k, as positions in `second`
    for (const auto& [low, high] : all.pencils.side(k, i).end_positions)
        strips.push_back({low, high});
    return {{"first", angles(i, k)}, {"second", angles(k, i)}, {"strips", strips}};
}

}  // namespace atrium::bench
