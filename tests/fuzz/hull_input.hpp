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

/// Any bytes are an input: 2 to 8 views from the good to the impossible. Limits are set so low that
/// a hull takes less than a second, sanitizers included. Missing bytes read as 0.
HullInput decode_hull_input(std::span<const std::uint8_t> bytes);

}  // namespace atrium::test
