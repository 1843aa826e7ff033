#pragma once

#include "viewer/renderer/person/person_model.hpp"

#include <Eigen/Core>

#include <array>
#include <cstdint>
#include <vector>

namespace atrium::exporting {

/// Parts of the surface, each flat in a picture of its own: no two triangles of a chart overlap.
struct Charts {
    struct Chart {
        Eigen::Vector2i low = Eigen::Vector2i::Zero();   // corner of its rectangle [texels]
        Eigen::Vector2i size = Eigen::Vector2i::Zero();  // [texels]
    };
    std::vector<Chart> charts;
    std::vector<std::uint32_t> chart_of;                 // per triangle
    std::vector<std::array<Eigen::Vector2f, 3>> places;  // per triangle: its corners [texels]
    std::vector<std::uint8_t> is_at_border;              // per triangle: beside another chart
    bool is_too_large = false;  // far more texels than people have; there are no charts
};

/// Charts are made at this scale however many texels they have.
inline constexpr float kLeastScale = 0.01f;

/// Divides the surface of a person into charts.
///
/// Each triangle goes to the camera that sees it best, with as many texels as its picture has
/// pixels, times `scale`, and at the same places within a texel: where one camera colours the
/// surface alone, the texture then has its pixels unchanged. Triangles that no camera sees go to
/// one of six parallel projections. Neighbours agree where that costs little. Triangles that would
/// cover others of their chart (an arm before the body) begin another chart. Deterministic.
Charts find_charts(const renderer::PersonModel& model, float scale);

/// Per triangle and edge (corner i to i + 1): the triangle beyond it; `kNoTriangle` at a border.
inline constexpr std::uint32_t kNoTriangle = 0xFFFFFFFF;
std::vector<std::array<std::uint32_t, 3>> neighbours(
    const std::vector<std::array<std::uint32_t, 3>>& triangles);

}  // namespace atrium::exporting
