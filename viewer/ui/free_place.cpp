#include "viewer/ui/free_place.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace atrium::viewer {
namespace {

float covered_px2(const PanelBox& a, const PanelBox& b) {
    const float width = std::min(a.left + a.width, b.left + b.width) - std::max(a.left, b.left);
    const float height = std::min(a.top + a.height, b.top + b.height) - std::max(a.top, b.top);
    return std::max(0.0f, width) * std::max(0.0f, height);
}

}  // namespace

PanelBox free_place(const PanelBox& wanted,
                    const std::vector<PanelBox>& taken,
                    float width,
                    float height,
                    float margin) {
    // a best place touches, but for the margin, an edge of the picture or of a panel
    std::vector<float> lefts{wanted.left, margin, width - margin - wanted.width};
    std::vector<float> tops{wanted.top, margin, height - margin - wanted.height};
    for (const PanelBox& box : taken) {
        lefts.insert(lefts.end(),
                     {box.left + box.width + margin, box.left - margin - wanted.width});
        tops.insert(tops.end(), {box.top + box.height + margin, box.top - margin - wanted.height});
    }
    PanelBox best = wanted;
    std::pair<float, float> least{std::numeric_limits<float>::infinity(), 0.0f};
    for (const float left : lefts) {
        for (const float top : tops) {
            PanelBox place = wanted;
            place.left = std::max(margin, std::min(left, width - margin - wanted.width));
            place.top = std::max(margin, std::min(top, height - margin - wanted.height));
            float covered = 0.0f;
            for (const PanelBox& box : taken) covered += covered_px2(place, box);
            const std::pair cost(covered,
                                 std::hypot(place.left - wanted.left, place.top - wanted.top));
            if (cost >= least) continue;
            least = cost;
            best = place;
        }
    }
    return best;
}

}  // namespace atrium::viewer
