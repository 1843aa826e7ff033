#include "site_node/occupied_room/never_empty.hpp"

#include "site_node/segmentation/component_votes.hpp"
#include "site_node/segmentation/outline_votes.hpp"

#include <algorithm>

namespace atrium::occupied_room {
namespace {

using Blocks = std::vector<std::uint8_t>;  // 0 or 1

struct Grid {
    int columns;
    int rows;
    std::size_t at(int column, int row) const {
        return static_cast<std::size_t>(row) * static_cast<std::size_t>(columns) +
               static_cast<std::size_t>(column);
    }
};

// Sets every block with `value` within `radius` along a row or column to it, and so on: a square.
Blocks spread(const Blocks& blocks, const Grid& grid, int radius, std::uint8_t value) {
    Blocks along = blocks;
    for (int y = 0; y < grid.rows; ++y) {
        for (int x = 0; x < grid.columns; ++x) {
            if (blocks[grid.at(x, y)] != value) continue;
            for (int i = std::max(x - radius, 0); i <= std::min(x + radius, grid.columns - 1); ++i)
                along[grid.at(i, y)] = value;
        }
    }
    Blocks both = along;
    for (int y = 0; y < grid.rows; ++y) {
        for (int x = 0; x < grid.columns; ++x) {
            if (along[grid.at(x, y)] != value) continue;
            for (int i = std::max(y - radius, 0); i <= std::min(y + radius, grid.rows - 1); ++i)
                both[grid.at(x, i)] = value;
        }
    }
    return both;
}

Blocks restless(const segmentation::BlockClusters& clusters, std::span<const std::uint8_t> chosen) {
    constexpr double kLasting = 0.65;  // share of the pictures
    std::vector<std::uint32_t> num(clusters.num_blocks(), 0);
    for (const auto& labels : clusters.labels) {
        for (std::size_t b = 0; b < num.size(); ++b) num[b] += labels[b] == chosen[b] ? 1 : 0;
    }
    Blocks blocks(num.size());
    for (std::size_t b = 0; b < num.size(); ++b)
        blocks[b] = num[b] < kLasting * static_cast<double>(clusters.labels.size()) ? 1 : 0;
    return blocks;
}

// Fills everything that does not reach the border of the picture.
void fill_holes(Blocks& blocks, const Grid& grid) {
    std::vector<std::int32_t> queue;
    Blocks outside(blocks.size(), 0);
    const auto reach = [&](int x, int y) {
        const std::size_t b = grid.at(x, y);
        if (blocks[b] != 0 || outside[b] != 0) return;
        outside[b] = 1;
        queue.push_back(static_cast<std::int32_t>(b));
    };
    for (int x = 0; x < grid.columns; ++x) {
        reach(x, 0);
        reach(x, grid.rows - 1);
    }
    for (int y = 0; y < grid.rows; ++y) {
        reach(0, y);
        reach(grid.columns - 1, y);
    }
    while (!queue.empty()) {
        const int x = queue.back() % grid.columns;
        const int y = queue.back() / grid.columns;
        queue.pop_back();
        if (x > 0) reach(x - 1, y);
        if (x + 1 < grid.columns) reach(x + 1, y);
        if (y > 0) reach(x, y - 1);
        if (y + 1 < grid.rows) reach(x, y + 1);
    }
    for (std::size_t b = 0; b < blocks.size(); ++b) blocks[b] = outside[b] != 0 ? 0 : 1;
}

// Outline of one part: how much of it lies on an edge of the room.
struct PartOutline {
    int size = 0;
    int num_outline = 0;
    int num_edges = 0;
};

}  // namespace

std::vector<std::uint8_t> find_never_empty(const segmentation::BlockClusters& clusters,
                                           std::span<const std::uint8_t> chosen,
                                           const segmentation::BackgroundStatistics& room,
                                           const image::Mask& where_people_can_be) {
    const Grid grid{clusters.columns, clusters.rows};
    const int radius = std::max(2, grid.columns / 60);
    Blocks blocks = restless(clusters, chosen);
    for (std::size_t b = 0; b < blocks.size(); ++b)
        if (where_people_can_be.data[b] == 0) blocks[b] = 0;
    blocks = spread(blocks, grid, radius, 1);
    fill_holes(blocks, grid);
    blocks = spread(blocks, grid, radius, 0);
    const segmentation::PartLabels parts =
        segmentation::label_parts(blocks, grid.columns, grid.rows);
    std::vector<PartOutline> outlines(static_cast<std::size_t>(parts.num));
    constexpr int kOut = 2;       // blocks
    constexpr int kMinEdge = 20;  // grey levels
    for (int y = 0; y < grid.rows; ++y) {
        for (int x = 0; x < grid.columns; ++x) {
            const std::size_t b = grid.at(x, y);
            if (blocks[b] == 0) continue;
            PartOutline& outline = outlines[static_cast<std::size_t>(parts.label[b])];
            ++outline.size;
            for (const auto& [dx, dy] : {std::pair{1, 0}, {-1, 0}, {0, 1}, {0, -1}}) {
                const int out_x = x + kOut * dx;
                const int out_y = y + kOut * dy;
                const int in_x = x - kOut * dx;
                const int in_y = y - kOut * dy;
                if (std::min({out_x, out_y, in_x, in_y}) < 0 ||
                    std::max(out_x, in_x) >= grid.columns || std::max(out_y, in_y) >= grid.rows)
                    continue;
                if (blocks[grid.at(x + dx, y + dy)] != 0 || blocks[grid.at(out_x, out_y)] != 0)
                    continue;
                ++outline.num_outline;
                outline.num_edges += segmentation::contrast(
                                         room, 2 * in_x, 2 * in_y, 2 * out_x, 2 * out_y) > kMinEdge
                                         ? 1
                                         : 0;
            }
        }
    }
    constexpr double kMinSize = 0.0015;  // of the picture
    for (std::size_t b = 0; b < blocks.size(); ++b) {
        if (blocks[b] == 0) continue;
        const PartOutline& outline = outlines[static_cast<std::size_t>(parts.label[b])];
        const bool has_edge = 2 * outline.num_edges > outline.num_outline;
        const bool is_large = outline.size > kMinSize * static_cast<double>(blocks.size());
        blocks[b] = has_edge && is_large ? 1 : 0;
    }
    return spread(blocks, grid, 1, 1);
}

}  // namespace atrium::occupied_room
