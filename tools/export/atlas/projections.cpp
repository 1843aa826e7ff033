#include "tools/export/atlas/projections.hpp"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <limits>

namespace atrium::exporting {
namespace {

constexpr float kNotANumber = std::numeric_limits<float>::quiet_NaN();
constexpr float kMaxOutside = 8.0f;  // [texels] so far outside a picture a vertex still counts
// Shares of the score of a camera that faces a triangle but does not see it, and of a parallel
// projection, which shows only the fallback colours.
constexpr float kUnseen = 0.5f;
constexpr float kParallel = 0.25f;
constexpr float kMaxParallelTexels = 2048.0f;  // longest side of a parallel projection
constexpr float kThinScore = 0.35f;            // least score of a thin triangle
constexpr float kUsualDensity = 200.0f;        // [texels/m] without cameras
constexpr float kSmoothTexels = 0.5f;  // density of smooth colours, relative to the cameras'

using Places = std::vector<Eigen::Vector2f>;

Places in_camera(const renderer::PersonModel& model,
                 const renderer::PersonModel::Camera& camera,
                 float scale) {
    const Eigen::Array2f size(static_cast<float>(model.layer_width),
                              static_cast<float>(model.layer_height));
    Places places(model.vertices_site.size(), Eigen::Vector2f::Constant(kNotANumber));
    for (std::size_t v = 0; v < places.size(); ++v) {
        const Eigen::Vector3f& st = camera.layer_coordinates[v];
        // project_points has (0, 0, 1) for "no projection"
        if (!(st.z() > 0.0f) || (st.x() == 0.0f && st.y() == 0.0f)) continue;
        const Eigen::Array2f texel = st.head<2>().array() / st.z() * size;
        if ((texel < -kMaxOutside).any() || (texel > size + kMaxOutside).any()) continue;
        places[v] = texel * scale;
    }
    return places;
}

Places along(const renderer::PersonModel& model, const Eigen::Vector3f& axis, float density) {
    const Eigen::Vector3f forward = -axis;
    const Eigen::Vector3f up =
        std::abs(axis.z()) > 0.5f ? Eigen::Vector3f::UnitY() : Eigen::Vector3f::UnitZ();
    const Eigen::Vector3f right = forward.cross(up);
    const Eigen::Vector3f down = forward.cross(right);
    Places places;
    places.reserve(model.vertices_site.size());
    for (const Eigen::Vector3f& p : model.vertices_site)
        places.emplace_back(p.dot(right) * density, p.dot(down) * density);
    return places;
}

float area_m2(const renderer::PersonModel& model, const std::array<std::uint32_t, 3>& triangle) {
    const Eigen::Vector3f& a = model.vertices_site[triangle[0]];
    return 0.5f * (model.vertices_site[triangle[1]] - a)
                      .cross(model.vertices_site[triangle[2]] - a)
                      .norm();
}

// Height over the longest edge.
float least_height_m(const renderer::PersonModel& model,
                     const std::array<std::uint32_t, 3>& triangle) {
    float longest = 1e-9f;
    for (std::size_t i = 0; i < 3; ++i) {
        const Eigen::Vector3f edge =
            model.vertices_site[triangle[(i + 1) % 3]] - model.vertices_site[triangle[i]];
        longest = std::max(longest, edge.norm());
    }
    return 2.0f * area_m2(model, triangle) / longest;
}

// Texels per metre; negative without a projection, 0 if the triangle faces away.
std::vector<float> densities(const renderer::PersonModel& model, const Places& places) {
    std::vector<float> result;
    result.reserve(model.triangles.size());
    for (const auto& triangle : model.triangles) {
        const float twice =
            twice_area(places[triangle[0]], places[triangle[1]], places[triangle[2]]);
        const float area = area_m2(model, triangle);
        if (std::isnan(twice))
            result.push_back(-1.0f);
        else
            result.push_back(twice < 0.0f && area > 0.0f ? std::sqrt(-0.5f * twice / area) : 0.0f);
    }
    return result;
}

// Density with which the better half of the surface can be shown.
float usual_density(const std::vector<std::vector<float>>& of_cameras,
                    std::size_t num_triangles,
                    float scale) {
    std::vector<float> best;
    for (std::size_t t = 0; t < num_triangles; ++t) {
        float most = 0.0f;
        for (const auto& densities : of_cameras) most = std::max(most, densities[t]);
        if (most > 0.0f) best.push_back(most);
    }
    if (best.empty()) return kUsualDensity * scale;
    const auto middle = best.begin() + static_cast<std::ptrdiff_t>(best.size() / 2);
    std::nth_element(best.begin(), middle, best.end());
    return *middle;
}

}  // namespace

Projections find_projections(const renderer::PersonModel& model, float scale) {
    Projections result;
    for (const auto& camera : model.cameras) {
        result.places.push_back(in_camera(model, camera, scale));
        result.scores.push_back(densities(model, result.places.back()));
    }
    const float usual = usual_density(result.scores, model.triangles.size(), scale);
    for (std::size_t c = 0; c < model.cameras.size(); ++c) {
        const renderer::PersonModel::Camera& camera = model.cameras[c];
        for (std::size_t t = 0; t < model.triangles.size(); ++t) {
            float& score = result.scores[c][t];
            if (score <= 0.0f) continue;
            float seen = 0.0f;
            for (const std::uint32_t v : model.triangles[t]) seen += camera.quality[v] / 3.0f;
            seen *= camera.facing[t];
            score = std::min(1.0f, score / usual) * (kUnseen + (1.0f - kUnseen) * seen);
        }
    }
    // people are not larger than that; data may be
    const float extent_m = std::max(1e-3f, model.bounds_site.sizes().maxCoeff());
    const float density = std::min(kSmoothTexels * usual, scale * kMaxParallelTexels / extent_m);
    for (int axis = 0; axis < 3; ++axis) {
        for (const float sign : {1.0f, -1.0f}) {
            result.places.push_back(along(model, sign * Eigen::Vector3f::Unit(axis), density));
            result.scores.push_back(densities(model, result.places.back()));
            for (float& score : result.scores.back()) score *= kParallel / density;
        }
    }
    result.is_thin.resize(model.triangles.size());
    for (std::size_t t = 0; t < model.triangles.size(); ++t) {
        result.is_thin[t] = least_height_m(model, model.triangles[t]) * usual < 1.0f;
        if (result.is_thin[t] == 0) continue;
        for (auto& scores : result.scores) {
            if (scores[t] >= 0.0f) scores[t] = std::max(scores[t], kThinScore);
        }
    }
    return result;
}

}  // namespace atrium::exporting
