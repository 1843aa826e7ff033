#pragma once

#include "viewer/renderer/person/person_model.hpp"

#include <Eigen/Core>

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace atrium::exporting {

/// The flat pictures into which charts can go: one per camera, then six parallel ones along the
/// axes of the site.
struct Projections {
    /// [projection][vertex], in texels, y down; not a number without a projection.
    std::vector<std::vector<Eigen::Vector2f>> places;
    /// [projection][triangle], up to 1: how well it shows the triangle. 0 if it does not face it,
    /// negative without a projection.
    std::vector<std::vector<float>> scores;
    /// Per triangle: narrower than a texel. It may go wherever its neighbours are, even turned
    /// over: it then shows the texels beside it.
    std::vector<std::uint8_t> is_thin;

    std::size_t size() const { return places.size(); }
};

Projections find_projections(const renderer::PersonModel& model, float scale);

/// Twice the signed area; negative for a triangle that faces the camera (y is down).
inline float twice_area(const Eigen::Vector2f& a,
                        const Eigen::Vector2f& b,
                        const Eigen::Vector2f& c) {
    return (b - a).x() * (c - a).y() - (b - a).y() * (c - a).x();
}

}  // namespace atrium::exporting
