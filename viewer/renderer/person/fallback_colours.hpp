#pragma once

#include "viewer/renderer/person/person_model.hpp"

#include <Eigen/Core>

#include <cstdint>
#include <span>
#include <vector>

namespace atrium::renderer {

struct FallbackScratch {
    std::vector<Eigen::Vector4f> seen;     // per vertex: colour times weight, and weight
    std::vector<Eigen::Vector4f> colours;  // per vertex: being smoothed
    std::vector<Eigen::Vector4f> sums;     // per vertex, over its neighbours
    std::vector<std::uint8_t> is_coloured;
    std::vector<std::uint32_t> uncertain;  // vertices
    std::vector<std::uint32_t> around;     // triangles with an uncertain corner
};

/// Computes `model.fallback`. A vertex that cameras see well has their mean colour. Elsewhere the
/// colours of the surroundings run into each other along the surface, the softer the farther away:
/// the less cameras see of a vertex, the less its own colour counts. Needs layers and quality of
/// the cameras. `texels` are the vertices' places in the layer of each camera.
void find_fallback_colours(std::span<const std::vector<std::int32_t>> texels,
                           FallbackScratch& scratch,
                           PersonModel& model);

}  // namespace atrium::renderer
