#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

namespace atrium::renderer {

/// How high what darkens a pixel of the shadow map is, so that only what lies below gets the
/// shadow.
class ShadowHeights {
public:
    /// Heights of the map end here [m]; what is higher counts as this high.
    static constexpr float kMostM = 4.0f;
    static constexpr int kSide = 128;  // cells, of several pixels each

    static std::uint8_t encode(double height_m) {
        return static_cast<std::uint8_t>(
            std::lround(std::clamp(255.0 / kMostM * height_m, 0.0, 255.0)));
    }

    void clear() { cells_.fill(0); }
    /// A point that casts its shadow at this place of a map of `side_px`. Ignored outside.
    void add(float x_px, float y_px, double height_m, int side_px) {
        const int x = cell_of(x_px, side_px), y = cell_of(y_px, side_px);
        if (x < 0 || y < 0 || x >= kSide || y >= kSide) return;
        std::uint8_t& cell = at(x, y);
        cell = std::max(cell, encode(height_m));
    }
    /// Of the highest point around this pixel, encoded.
    std::uint8_t around(int x_px, int y_px, int side_px) const {
        const int x = x_px * kSide / side_px, y = y_px * kSide / side_px;
        if (const std::uint8_t here = at(x, y); here > 0) return here;
        // between two points that are far apart
        std::uint8_t highest = 0;
        for (int j = std::max(0, y - 1); j <= std::min(kSide - 1, y + 1); ++j)
            for (int i = std::max(0, x - 1); i <= std::min(kSide - 1, x + 1); ++i)
                highest = std::max(highest, at(i, j));
        return highest;
    }

private:
    static int cell_of(float px, int side_px) {
        const float cell = std::floor((px + 0.5f) * kSide / static_cast<float>(side_px));
        return cell >= 0.0f && cell < static_cast<float>(kSide) ? static_cast<int>(cell) : -1;
    }
    std::uint8_t& at(int x, int y) { return cells_[static_cast<std::size_t>(y * kSide + x)]; }
    std::uint8_t at(int x, int y) const { return cells_[static_cast<std::size_t>(y * kSide + x)]; }

    std::array<std::uint8_t, std::size_t{kSide} * kSide> cells_{};
};

}  // namespace atrium::renderer
