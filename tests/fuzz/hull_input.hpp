#pragma once

#include "site_node/hull/visual_hull.hpp"

#include <cstdint>
#include <span>
#include <vector>

namespace atrium::test {

struct HullInput {
    std::vector<hull::SilhouetteView> views;
    hull::HullOptions options;
};

/// Any bytes are an input: 2 to 8 views from good to impossible. Low limits keep a hull below a
/// second, even with sanitizers. Missing bytes read as 0.
HullInput decode_hull_input(std::span<const std::uint8_t> bytes);

}  // namespace atrium::test
