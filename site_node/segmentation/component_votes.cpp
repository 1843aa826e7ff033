#include "site_node/segmentation/component_votes.hpp"

#include "site_node/segmentation/outline_votes.hpp"

#include <algorithm>

namespace atrium::segmentation {
namespace {

// Labels the 4-connected parts of the cells with `is_set`; calls `visit(cell)` for each cell of the
// part. Returns the number of parts.
template <typename IsSet, typename Visit>
std::int32_t label_parts(int width,
                         int height,
                         const IsSet& is_set,
                         std::vector<std::int32_t>& labels,
                         std::vector<std::int32_t>& queue,
                         const Visit& visit) {
    labels.assign(static_cast<std::size_t>(width) * static_cast<std::size_t>(height), -1);
    std::int32_t num_parts = 0;
    for (std::int32_t start = 0; start < static_cast<std::int32_t>(labels.size()); ++start) {
        if (labels[static_cast<std::size_t>(start)] >= 0 || !is_set(start)) continue;
        queue.assign(1, start);
        labels[static_cast<std::size_t>(start)] = num_parts;
        for (std::size_t next = 0; next < queue.size(); ++next) {
            const std::int32_t cell = queue[next];
            visit(cell, num_parts);
            const auto reach = [&](bool is_inside, std::int32_t to) {
                if (!is_inside || labels[static_cast<std::size_t>(to)] >= 0 || !is_set(to)) return;
                labels[static_cast<std::size_t>(to)] = num_parts;
                queue.push_back(to);
            };
            const int x = cell % width;
            reach(x > 0, cell - 1);
            reach(x + 1 < width, cell + 1);
            reach(cell >= width, cell - width);
            reach(cell + width < static_cast<std::int32_t>(labels.size()), cell + width);
        }
        ++num_parts;
    }
    return num_parts;
}

bool is_ghost(const ComponentVotes& votes) {
    constexpr int kFewest = 12;
    return votes.room >= kFewest && 2 * votes.room > 3 * votes.picture;
}

}  // namespace

void count_votes(const image::YuvView& picture,
                 const BackgroundStatistics& room,
                 const image::Mask& mask,
                 ComponentScratch& scratch) {
    scratch.components.clear();
    label_parts(
        mask.width,
        mask.height,
        [&](std::int32_t pixel) { return mask.data[static_cast<std::size_t>(pixel)] != 0; },
        scratch.label,
        scratch.queue,
        [&](std::int32_t pixel, std::int32_t part) {
            if (static_cast<std::size_t>(part) == scratch.components.size())
                scratch.components.emplace_back();
            ComponentVotes& component = scratch.components.back();
            ++component.size;
            component.sum_x += pixel % mask.width;
            component.sum_y += pixel / mask.width;
        });
    visit_outline(picture, room, mask, [&](int x, int y, OutlineVote vote) {
        const std::int32_t label =
            scratch.label[static_cast<std::size_t>(y) * static_cast<std::size_t>(mask.width) +
                          static_cast<std::size_t>(x)];
        ComponentVotes& votes = scratch.components[static_cast<std::size_t>(label)];
        votes.picture += vote == OutlineVote::kPicture ? 1 : 0;
        votes.room += vote == OutlineVote::kRoom ? 1 : 0;
    });
}

bool is_clear_ghost(const ComponentVotes& votes) {
    constexpr int kFewest = 40;
    return votes.room >= kFewest && votes.room > 2 * votes.picture;
}

bool has_size_of_person(std::int32_t num_pixels, const image::Mask& mask) {
    constexpr double kMinSize = 0.003;  // of the picture
    return num_pixels > kMinSize * static_cast<double>(mask.data.size());
}

image::Mask judge_components(const image::YuvView& picture,
                             const BackgroundStatistics& room,
                             const image::Mask& mask,
                             ComponentScratch& scratch) {
    count_votes(picture, room, mask, scratch);
    const auto label_at = [&](int x, int y) {
        return static_cast<std::size_t>(
            scratch.label[static_cast<std::size_t>(y) * static_cast<std::size_t>(mask.width) +
                          static_cast<std::size_t>(x)]);
    };
    image::Mask states(mask.width / 2, mask.height / 2);
    for (int row = 0; row < states.height; ++row) {
        for (int column = 0; column < states.width; ++column) {
            int num_person = 0;
            int num_ghost = 0;
            for (const int y : {2 * row, 2 * row + 1}) {
                for (const int x : {2 * column, 2 * column + 1}) {
                    if (mask.at(x, y) == 0) continue;
                    ++(is_ghost(scratch.components[label_at(x, y)]) ? num_ghost : num_person);
                }
            }
            const BlockState state = num_person + num_ghost < 2 ? BlockState::kRoom
                                     : num_ghost > num_person   ? BlockState::kGhost
                                                                : BlockState::kPerson;
            states.row(row)[column] = static_cast<std::uint8_t>(state);
        }
    }
    return states;
}

PartLabels label_parts(std::span<const std::uint8_t> cells, int columns, int rows) {
    PartLabels parts;
    std::vector<std::int32_t> queue;
    parts.num = label_parts(
        columns,
        rows,
        [&](std::int32_t cell) { return cells[static_cast<std::size_t>(cell)] != 0; },
        parts.label,
        queue,
        [](std::int32_t, std::int32_t) {});
    return parts;
}

image::PixelRect largest_part(std::span<const std::uint8_t> blocks, int columns, int rows) {
    std::vector<std::int32_t> labels;
    std::vector<std::int32_t> queue;
    struct Part {
        int left, top, right, bottom, size = 0;
    };
    std::vector<Part> parts;
    label_parts(
        columns,
        rows,
        [&](std::int32_t block) { return blocks[static_cast<std::size_t>(block)] != 0; },
        labels,
        queue,
        [&](std::int32_t block, std::int32_t label) {
            const int x = block % columns;
            const int y = block / columns;
            if (static_cast<std::size_t>(label) == parts.size()) parts.push_back({x, y, x, y});
            Part& part = parts.back();
            part.left = std::min(part.left, x);
            part.right = std::max(part.right, x);
            part.top = std::min(part.top, y);
            part.bottom = std::max(part.bottom, y);
            ++part.size;
        });
    const auto largest = std::max_element(
        parts.begin(), parts.end(), [](const Part& a, const Part& b) { return a.size < b.size; });
    if (largest == parts.end()) return {};
    return {2 * largest->left,
            2 * largest->top,
            2 * (largest->right - largest->left + 1),
            2 * (largest->bottom - largest->top + 1)};
}

}  // namespace atrium::segmentation
