#pragma once

#include <span>

namespace atrium::viewer {

/// Lays out a graph: its title and newest value above, a scale with units at its left, the time
/// below, so nothing is written over the curve. `values`: equally spaced over the last `seconds`,
/// oldest first; 0: no value. The scale reaches at least to `least_top`. Inside an ImGui window.
void draw_curve(const char* title,
                const char* unit,
                std::span<const float> values,
                float least_top,
                double seconds);

/// Top of a scale that holds `largest`: 1, 2 or 5 times a power of ten.
float top_of_scale(float largest);

}  // namespace atrium::viewer
