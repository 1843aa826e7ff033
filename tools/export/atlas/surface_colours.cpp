#include "tools/export/atlas/surface_colours.hpp"

#include <algorithm>
#include <cmath>

namespace atrium::exporting {
namespace {

// As GL samples a texture: bilinear, texel centres at 0.5, clamped to the edge.
Eigen::Vector4f texel_at(const std::uint8_t* layer, int width, int height, float s, float t) {
    const float x =
        std::clamp(s * static_cast<float>(width) - 0.5f, 0.0f, static_cast<float>(width - 1));
    const float y =
        std::clamp(t * static_cast<float>(height) - 0.5f, 0.0f, static_cast<float>(height - 1));
    const int x0 = static_cast<int>(x);
    const int y0 = static_cast<int>(y);
    const int x1 = std::min(x0 + 1, width - 1);
    const int y1 = std::min(y0 + 1, height - 1);
    const float fx = x - static_cast<float>(x0);
    const float fy = y - static_cast<float>(y0);
    const auto at = [&](int px, int py) {
        const std::uint8_t* texel = layer + 4 * (static_cast<std::ptrdiff_t>(py) * width + px);
        return Eigen::Vector4f(texel[0], texel[1], texel[2], texel[3]);
    };
    const Eigen::Vector4f upper = at(x0, y0) * (1.0f - fx) + at(x1, y0) * fx;
    const Eigen::Vector4f lower = at(x0, y1) * (1.0f - fx) + at(x1, y1) * fx;
    return (upper * (1.0f - fy) + lower * fy) / 255.0f;
}

}  // namespace

Eigen::Vector3f TriangleColours::at(const Eigen::Vector3f& shares) const {
    const auto mix = [&](const auto& corners) {
        return (corners[0] * shares[0] + corners[1] * shares[1] + corners[2] * shares[2]).eval();
    };
    Eigen::Vector4f sum;
    sum << mix(fallback_), 1.0f;
    sum *= renderer::kFallbackWeight;
    for (std::size_t i = 0; i < num_slots_; ++i) {
        const Eigen::Vector4f picture = mix(slots_[i].corners);
        if (picture.w() <= 0.0f) continue;
        sum += picture.w() * texel_at(slots_[i].layer,
                                      width_,
                                      height_,
                                      picture.x() / picture.z(),
                                      picture.y() / picture.z());
    }
    return (sum.head<3>() / sum.w()).cwiseMax(0.0f).cwiseMin(1.0f);
}

SurfaceColours::SurfaceColours(const renderer::PersonModel& model,
                               const std::optional<Eigen::Vector3f>& eye_site)
    : model_(model) {
    renderer::BlendScratch scratch;
    renderer::blend_for_texture(model, scratch, blended_[0]);
    if (eye_site) renderer::blend_for_view(model, *eye_site, scratch, blended_[1]);
    places_.resize(model.triangles.size());
    for (std::uint32_t b = 0; b < blended_.size(); ++b) {
        for (std::uint32_t g = 0; g < blended_[b].groups.size(); ++g) {
            const auto& triangles = blended_[b].groups[g].triangles;
            for (std::uint32_t i = 0; i < triangles.size(); ++i) places_[triangles[i]] = {b, g, i};
        }
    }
}

TriangleColours SurfaceColours::of(std::uint32_t triangle) const {
    TriangleColours result;
    result.width_ = model_.layer_width;
    result.height_ = model_.layer_height;
    const std::size_t layer_bytes = 4 * static_cast<std::size_t>(model_.layer_width) *
                                    static_cast<std::size_t>(model_.layer_height);
    const Place place = places_[triangle];
    const std::size_t num_slots = renderer::kCamerasPerTriangle[place.group];
    const auto& corners = model_.triangles[triangle];
    for (std::size_t i = 0; i < 3; ++i) result.fallback_[i] = model_.fallback[corners[i]];
    for (std::size_t k = 0; k < num_slots; ++k) {
        const renderer::BlendSlot& slot =
            blended_[place.blended].groups[place.group].slots[place.index * num_slots + k];
        if (std::ranges::all_of(slot.weights, [](float weight) { return weight <= 0.0f; }))
            continue;
        TriangleColours::Slot& out = result.slots_[result.num_slots_++];
        out.layer = model_.layers.data() + slot.camera * layer_bytes;
        for (std::size_t i = 0; i < 3; ++i) {
            out.corners[i] << model_.cameras[slot.camera].layer_coordinates[corners[i]],
                slot.weights[i];
        }
    }
    return result;
}

std::vector<Eigen::Vector3f> SurfaceColours::at_vertices() const {
    std::vector<Eigen::Vector4f> sums(model_.vertices_site.size(), Eigen::Vector4f::Zero());
    for (std::uint32_t t = 0; t < model_.triangles.size(); ++t) {
        const TriangleColours colours = of(t);
        for (int i = 0; i < 3; ++i) {
            Eigen::Vector4f seen;
            seen << colours.at(Eigen::Vector3f::Unit(i)), 1.0f;
            sums[model_.triangles[t][static_cast<std::size_t>(i)]] += seen;
        }
    }
    std::vector<Eigen::Vector3f> result;
    result.reserve(sums.size());
    for (const Eigen::Vector4f& sum : sums)
        result.push_back(sum.head<3>() / std::max(1.0f, sum.w()));
    return result;
}

}  // namespace atrium::exporting
