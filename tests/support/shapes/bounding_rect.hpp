#pragma once

#include "core/image/image.hpp"

#include <algorithm>

namespace atrium::test {

/// Returns the smallest rectangle with all foreground; empty without any.
inline image::PixelRect bounding_rect(const image::Mask& mask) {
    int left = mask.width, right = 0, top = mask.height, bottom = 0;
    for (int y = 0; y < mask.height; ++y) {
        for (int x = 0; x < mask.width; ++x) {
            if (mask.at(x, y) == 0) continue;
            left = std::min(left, x);
            right = std::max(right, x + 1);
            top = std::min(top, y);
            bottom = y + 1;
        }
    }
    if (bottom == 0) return {};
    return {left, top, right - left, bottom - top};
}

}  // namespace atrium::test
