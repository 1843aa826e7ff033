#include "site_node/segmentation/edge_width.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdlib>
#include <vector>

namespace atrium::segmentation {
namespace {

constexpr int kLevel = 256;               // BackgroundStatistics::luma
constexpr int kLeastSlope = 10 * kLevel;  // from pixel to pixel
constexpr int kLeastContrast = 24 * kLevel;
constexpr int kFlatChange = 3 * kLevel;  // largest change on either side
constexpr int kStepReach = 6;            // of a step and its sides [px]
constexpr std::size_t kFewestSteps = 40;
constexpr std::size_t kSharpest = 10;  // one of so many

// Adds the widths of the steps along `num` values that are `stride` apart.
void add_widths(const std::uint16_t* values,
                std::ptrdiff_t stride,
                int num,
                std::vector<double>& widths) {
    const auto at = [&](int i) { return static_cast<int>(values[i * stride]); };
    const auto slope = [&](int i) { return std::abs(at(i + 1) - at(i)); };
    for (int i = kStepReach; i + kStepReach + 1 < num; ++i) {
        const int steepest = slope(i);
        if (steepest < kLeastSlope) continue;
        bool is_peak = true;
        for (int k = i - 4; k <= i + 4; ++k) is_peak = is_peak && slope(k) <= steepest;
        const bool is_isolated = std::abs(at(i - 5) - at(i - 3)) <= kFlatChange &&
                                 std::abs(at(i + 4) - at(i + 6)) <= kFlatChange;
        const int contrast = std::abs(at(i + 4) - at(i - 3));
        if (is_peak && is_isolated && contrast >= kLeastContrast)
            widths.push_back(static_cast<double>(contrast) / steepest);
    }
}

}  // namespace

std::optional<double> edge_width_px(const BackgroundStatistics& room) {
    if (room.mosaic != image::Mosaic::kNone) return std::nullopt;
    std::vector<double> widths;
    for (int y = 0; y < room.height; y += 2)
        add_widths(
            room.luma.data() + static_cast<std::ptrdiff_t>(y) * room.width, 1, room.width, widths);
    for (int x = 0; x < room.width; x += 2)
        add_widths(room.luma.data() + x, room.width, room.height, widths);
    if (widths.size() < kFewestSteps) return std::nullopt;
    const auto place = widths.begin() + static_cast<std::ptrdiff_t>(widths.size() / kSharpest);
    std::ranges::nth_element(widths, place);
    return *place;
}

}  // namespace atrium::segmentation
