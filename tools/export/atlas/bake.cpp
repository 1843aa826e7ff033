#include "tools/export/atlas/bake.hpp"

#include "tools/export/atlas/charts.hpp"
#include "tools/export/atlas/fill_gaps.hpp"
#include "tools/export/atlas/packing.hpp"
#include "tools/export/atlas/surface_colours.hpp"
#include "tools/export/atlas/texels_inside.hpp"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>

namespace atrium::exporting {
namespace {

constexpr float kRim = 1.0f;                    // [texels] around charts that filtering reads
constexpr float kSmaller = 0.75f;               // scale of the next try
constexpr double kGolden = 0.7548776662466927;  // of the R2 sequence (Roberts 2018)
constexpr double kGolden2 = 0.5698402909980532;

struct Atlas {
    Charts charts;
    Packing packing;
};

Atlas make_atlas(const renderer::PersonModel& model) {
    for (float scale = 1.0f;; scale *= kSmaller) {
        Atlas atlas;
        atlas.charts = find_charts(model, scale);
        if (atlas.charts.is_too_large) continue;
        std::vector<Eigen::Vector2i> sizes;
        for (const Charts::Chart& chart : atlas.charts.charts) sizes.push_back(chart.size);
        atlas.packing = pack(sizes);
        if (atlas.packing.size.maxCoeff() > kMaxTextureSidePx && scale > kLeastScale) continue;
        for (std::size_t t = 0; t < model.triangles.size(); ++t) {
            const std::uint32_t chart = atlas.charts.chart_of[t];
            const Eigen::Vector2i move =
                atlas.packing.places[chart] - atlas.charts.charts[chart].low;
            for (Eigen::Vector2f& place : atlas.charts.places[t]) place += move.cast<float>();
        }
        return atlas;
    }
}

// Barycentric coordinates of the nearest point inside, roughly.
Eigen::Vector3f pulled_inside(const Eigen::Vector3f& shares) {
    const Eigen::Vector3f positive = shares.cwiseMax(0.0f);
    return positive / positive.sum();
}

void paint(const renderer::PersonModel& model,
           const Atlas& atlas,
           const SurfaceColours& surface,
           Picture& picture) {
    picture.width = atlas.packing.size.x();
    picture.height = atlas.packing.size.y();
    const std::size_t num_texels =
        static_cast<std::size_t>(picture.width) * static_cast<std::size_t>(picture.height);
    picture.rgba.assign(4 * num_texels, 0);
    std::vector<std::uint8_t> is_known(num_texels, 0);
    const auto paint_triangle = [&](std::uint32_t t, float margin) {
        const TriangleColours colours = surface.of(t);
        for_texels_inside(
            atlas.charts.places[t], margin, [&](int x, int y, const Eigen::Vector3f& shares) {
                if (x >= picture.width || y >= picture.height) return;
                const std::size_t texel =
                    static_cast<std::size_t>(y) * static_cast<std::size_t>(picture.width) +
                    static_cast<std::size_t>(x);
                if (is_known[texel] != 0) return;
                is_known[texel] = 1;
                const Eigen::Vector3f colour =
                    colours.at(margin > 0.0f ? pulled_inside(shares) : shares);
                for (int c = 0; c < 3; ++c) {
                    picture.rgba[4 * texel + static_cast<std::size_t>(c)] =
                        static_cast<std::uint8_t>(colour[c] * 255.0f + 0.5f);
                }
            });
    };
    const auto num_triangles = static_cast<std::uint32_t>(model.triangles.size());
    for (std::uint32_t t = 0; t < num_triangles; ++t) paint_triangle(t, 0.0f);
    for (std::uint32_t t = 0; t < num_triangles; ++t) {
        if (atlas.charts.is_at_border[t] != 0) paint_triangle(t, kRim);
    }
    fill_gaps(is_known, picture);
}

void add_vertices(const renderer::PersonModel& model, const Atlas& atlas, TexturedMesh& out) {
    const Eigen::Array2f size = atlas.packing.size.cast<float>();
    // vertices of a position, by chart: few
    std::vector<std::vector<std::pair<std::uint32_t, std::uint32_t>>> made(
        model.vertices_site.size());
    out.triangles.resize(model.triangles.size());
    for (std::size_t t = 0; t < model.triangles.size(); ++t) {
        const std::uint32_t chart = atlas.charts.chart_of[t];
        for (std::size_t i = 0; i < 3; ++i) {
            const std::uint32_t position = model.triangles[t][i];
            auto& of_position = made[position];
            const auto found =
                std::ranges::find(of_position, chart, [](const auto& one) { return one.first; });
            if (found != of_position.end()) {
                out.triangles[t][i] = found->second;
                continue;
            }
            const auto vertex = static_cast<std::uint32_t>(out.uvs.size());
            of_position.emplace_back(chart, vertex);
            out.position_of.push_back(position);
            out.uvs.emplace_back(atlas.charts.places[t][i].array() / size);
            out.triangles[t][i] = vertex;
        }
    }
}

}  // namespace

TexturedMesh bake(const renderer::PersonModel& model, const Eye& eye_site) {
    TexturedMesh out;
    if (model.triangles.empty()) return out;
    const Atlas atlas = make_atlas(model);
    out.positions = model.vertices_site;
    add_vertices(model, atlas, out);
    paint(model, atlas, SurfaceColours(model, eye_site), out.texture);
    return out;
}

ColouredMesh colour_vertices(const renderer::PersonModel& model, const Eye& eye_site) {
    return {model.vertices_site, SurfaceColours(model, eye_site).at_vertices(), model.triangles};
}

PointCloud sample(const renderer::PersonModel& model, std::size_t count, const Eye& eye_site) {
    PointCloud out;
    std::vector<double> area_to;  // of the triangles up to each one
    double area = 0.0;
    for (const auto& [a, b, c] : model.triangles) {
        const Eigen::Vector3f& p = model.vertices_site[a];
        area += 0.5 * static_cast<double>(
                          (model.vertices_site[b] - p).cross(model.vertices_site[c] - p).norm());
        area_to.push_back(area);
    }
    if (!(area > 0.0)) return out;
    const SurfaceColours surface(model, eye_site);
    std::uint32_t t = 0;
    TriangleColours colours = surface.of(t);
    for (std::size_t i = 0; i < count; ++i) {
        const double place = (static_cast<double>(i) + 0.5) / static_cast<double>(count) * area;
        if (place > area_to[t]) {
            while (t + 1 < area_to.size() && area_to[t] < place) ++t;
            colours = surface.of(t);
        }
        // an even sequence in the unit square, folded onto the triangle
        double u = std::fmod(0.5 + static_cast<double>(i + 1) * kGolden, 1.0);
        double v = std::fmod(0.5 + static_cast<double>(i + 1) * kGolden2, 1.0);
        if (u + v > 1.0) {
            u = 1.0 - u;
            v = 1.0 - v;
        }
        const Eigen::Vector3f shares(
            static_cast<float>(1.0 - u - v), static_cast<float>(u), static_cast<float>(v));
        const auto& corners = model.triangles[t];
        Eigen::Vector3f position = Eigen::Vector3f::Zero();
        Eigen::Vector3f normal = Eigen::Vector3f::Zero();
        for (std::size_t k = 0; k < 3; ++k) {
            position += shares[static_cast<int>(k)] * model.vertices_site[corners[k]];
            normal += shares[static_cast<int>(k)] * model.normals[corners[k]];
        }
        out.positions.push_back(position);
        out.normals.push_back(normal.stableNormalized());
        out.colours.push_back(colours.at(shares));
    }
    return out;
}

}  // namespace atrium::exporting
