#include "viewer/ui/panel_layout.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <utility>

namespace atrium::viewer {
namespace {

// A panel rather lacks a third of its area than stands on another side than usual.
constexpr float kCostOfOtherSide = 0.1f;

float covered_px2(const PanelBox& a, const PanelBox& b) {
    const PanelBox common = common_part(a, b);
    return common.width * common.height;
}

bool is_on_the_right(Corner corner) {
    return corner == Corner::kUpperRight || corner == Corner::kLowerRight;
}
bool is_at_the_bottom(Corner corner) {
    return corner == Corner::kLowerLeft || corner == Corner::kLowerRight;
}

PanelBox in_corner(const PanelWish& wish, const PanelRoom& room) {
    PanelBox box{room.margin, room.margin, wish.width, wish.height};
    if (is_on_the_right(wish.corner)) box.left = room.width - room.margin - box.width;
    if (is_at_the_bottom(wish.corner)) box.top = room.height - room.margin - box.height;
    return box;
}

// All at the size that they want. Empty: one would cover another one.
std::optional<std::vector<PanelBox>> place_uncut(const std::vector<PanelWish>& wishes,
                                                 const PanelRoom& room) {
    std::vector<PanelBox> boxes;
    for (const PanelWish& wish : wishes) {
        const PanelBox box =
            free_place(in_corner(wish, room), boxes, room.width, room.height, room.margin);
        for (const PanelBox& other : boxes)
            if (covered_px2(box, other) > 0.0f) return std::nullopt;
        boxes.push_back(box);
    }
    return boxes;
}

// Shares a length so that the largest are cut, all to the same length.
std::vector<float> share_of(const std::vector<float>& wanted, float length) {
    std::vector<float> given(wanted.size(), 0.0f);
    std::vector<std::size_t> order(wanted.size());
    for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
    std::ranges::sort(order, [&](std::size_t a, std::size_t b) { return wanted[a] < wanted[b]; });
    float left = std::max(0.0f, length);
    for (std::size_t k = 0; k < order.size(); ++k) {
        const float share = left / static_cast<float>(order.size() - k);
        given[order[k]] = std::min(wanted[order[k]], share);
        left -= given[order[k]];
    }
    return given;
}

struct Columns {
    std::vector<PanelBox> boxes;
    float cut = 0.0f;  // sum of the squared shares that the panels lack
};

// Bit i of `right`: panel i stands in the right column.
Columns in_columns(const std::vector<PanelWish>& wishes, const PanelRoom& room, unsigned right) {
    Columns columns{std::vector<PanelBox>(wishes.size()), 0.0f};
    std::array<float, 2> widest{};
    for (std::size_t i = 0; i < wishes.size(); ++i) {
        float& width = widest[(right >> i) & 1u];
        width = std::max(width, wishes[i].width + room.scrollbar);
    }
    const bool has_two = widest[0] > 0.0f && widest[1] > 0.0f;
    const float across = room.width - (has_two ? 3.0f : 2.0f) * room.margin;
    const std::vector<float> widths = share_of({widest[0], widest[1]}, across);
    for (const unsigned side : {0u, 1u}) {
        std::vector<std::size_t> members;
        std::vector<float> heights;
        for (std::size_t i = 0; i < wishes.size(); ++i) {
            if (((right >> i) & 1u) != side) continue;
            const bool is_cut = wishes[i].width > widths[side];
            members.push_back(i);
            heights.push_back(wishes[i].height + (is_cut ? room.scrollbar : 0.0f));
        }
        const auto num = static_cast<float>(members.size());
        heights = share_of(heights, room.height - (num + 1.0f) * room.margin);
        float top = room.margin;
        float bottom = room.height - room.margin;
        for (std::size_t k = 0; k < members.size(); ++k) {
            const PanelWish& wish = wishes[members[k]];
            PanelBox& box = columns.boxes[members[k]];
            const bool is_cut = heights[k] < wish.height;
            box.width = std::min(widths[side], wish.width + (is_cut ? room.scrollbar : 0.0f));
            box.height = heights[k];
            box.left = side == 0u ? room.margin : room.width - room.margin - box.width;
            const bool is_low = is_at_the_bottom(wish.corner);
            box.top = is_low ? bottom - box.height : top;
            (is_low ? bottom : top) += (is_low ? -1.0f : 1.0f) * (box.height + room.margin);
            const float cut = 1.0f - std::min(box.width, wish.width) *
                                         std::min(box.height, wish.height) /
                                         std::max(1.0f, wish.width * wish.height);
            columns.cut += cut * cut;
        }
    }
    return columns;
}

}  // namespace

PanelBox common_part(const PanelBox& a, const PanelBox& b) {
    PanelBox common{std::max(a.left, b.left), std::max(a.top, b.top), 0.0f, 0.0f};
    common.width = std::max(0.0f, std::min(a.left + a.width, b.left + b.width) - common.left);
    common.height = std::max(0.0f, std::min(a.top + a.height, b.top + b.height) - common.top);
    return common;
}

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

std::vector<PanelBox> lay_out_panels(const std::vector<PanelWish>& wishes, const PanelRoom& room) {
    std::vector<PanelWish> cut = wishes;
    unsigned usual = 0;
    for (std::size_t i = 0; i < cut.size(); ++i) {
        cut[i].width = std::min(cut[i].width, room.width - 2.0f * room.margin);
        const float highest = room.height - 2.0f * room.margin;
        if (cut[i].height > highest)
            cut[i].width = std::min(cut[i].width + room.scrollbar, room.width - 2.0f * room.margin);
        cut[i].height = std::min(cut[i].height, highest);
        if (is_on_the_right(cut[i].corner)) usual |= 1u << i;
    }
    if (auto boxes = place_uncut(cut, room)) return std::move(*boxes);
    Columns best;
    float least = std::numeric_limits<float>::infinity();
    for (unsigned right = 0; right < 1u << cut.size(); ++right) {
        Columns columns = in_columns(cut, room, right);
        const float cost =
            columns.cut + kCostOfOtherSide * static_cast<float>(std::popcount(right ^ usual));
        if (cost >= least) continue;
        least = cost;
        best = std::move(columns);
    }
    return std::move(best.boxes);
}

}  // namespace atrium::viewer
