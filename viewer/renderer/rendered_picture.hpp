#pragma once

#include <cstdint>
#include <vector>

namespace atrium::renderer {

/// 8-bit RGBA, top row first.
struct RenderedPicture {
    int width = 0;
    int height = 0;
    std::vector<std::uint8_t> rgba;
};

enum class Antialias : std::uint8_t { kNone, kFxaa };

}  // namespace atrium::renderer
