#include "site_node/segmentation/steady_picture.hpp"

#include "site_node/segmentation/component_votes.hpp"
#include "site_node/segmentation/segmentation.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <vector>

namespace atrium::segmentation {
namespace {

constexpr int kTolerance = 10;  // [grey levels]: noise and flicker

// The median of a pixel's values, and whether most of them are about that.
struct Median {
    std::uint8_t value;
    bool is_steady;
};
Median median_of(std::vector<std::uint8_t>& values) {
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    const std::uint8_t median = *middle;
    const auto num_alike = std::ranges::count_if(
        values, [&](std::uint8_t value) { return std::abs(value - median) <= kTolerance; });
    return {median, 5 * num_alike >= 3 * std::ssize(values)};
}

// Writes the medians of the planes, or the means where all values are alike, which is nearly
// everywhere and cheap. Returns 255 where the pictures are steady.
image::Mask find_medians(std::span<const image::YuvImage> pictures,
                         image::Plane image::YuvImage::*plane,
                         image::Plane& median) {
    const image::Plane& first = pictures.front().*plane;
    const auto width = static_cast<std::size_t>(first.width);
    median = image::Plane(first.width, first.height);
    image::Mask is_steady(first.width, first.height, 255);
    std::vector<std::uint8_t> values(pictures.size());
    std::vector<std::uint8_t> low(width);
    std::vector<std::uint8_t> high(width);
    std::vector<std::uint32_t> sum(width);
    for (int y = 0; y < first.height; ++y) {
        std::copy_n(first.row(y), width, low.begin());
        std::copy_n(first.row(y), width, high.begin());
        std::ranges::fill(sum, 0);
        for (const image::YuvImage& picture : pictures) {
            const std::uint8_t* const row = (picture.*plane).row(y);
            for (std::size_t x = 0; x < width; ++x) {
                low[x] = std::min(low[x], row[x]);
                high[x] = std::max(high[x], row[x]);
                sum[x] += row[x];
            }
        }
        for (std::size_t x = 0; x < width; ++x) {
            median.row(y)[x] =
                static_cast<std::uint8_t>((sum[x] + pictures.size() / 2) / pictures.size());
            if (high[x] - low[x] <= kTolerance) continue;
            for (std::size_t k = 0; k < values.size(); ++k)
                values[k] = (pictures[k].*plane).row(y)[x];
            const Median found = median_of(values);
            median.row(y)[x] = found.value;
            is_steady.row(y)[x] = found.is_steady ? 255 : 0;
        }
    }
    return is_steady;
}

image::YuvImage picture_of(const BackgroundStatistics& room) {
    image::YuvImage picture{image::Plane(room.width, room.height),
                            image::Plane(room.width / 2, room.height / 2),
                            image::Plane(room.width / 2, room.height / 2)};
    const auto byte = [](int value) {
        return static_cast<std::uint8_t>(std::clamp(value, 0, 255));
    };
    for (std::size_t i = 0; i < room.luma.size(); ++i)
        picture.y.data[i] = byte((room.luma[i] + 128) / 256);
    for (std::size_t i = 0; i < room.u.size(); ++i) {
        picture.u.data[i] = byte(128 + room.u[i] / 128);
        picture.v.data[i] = byte(128 + room.v[i] / 128);
    }
    return picture;
}

// What both tests call foreground. A shadow is background in one of them.
std::optional<image::Mask> differing_both_ways(const BackgroundStatistics& room,
                                               const image::YuvImage& take,
                                               const SegmentationOptions& options) {
    BackgroundLearner learner;
    if (!learner.add(take)) return std::nullopt;
    auto reverse = learner.finish();
    if (!reverse) return std::nullopt;
    image::Mask differs;
    image::Mask differs_reversed;
    if (!Segmenter(room, options).segment(take, differs)) return std::nullopt;
    if (!Segmenter(std::move(*reverse), options).segment(picture_of(room), differs_reversed))
        return std::nullopt;
    for (std::size_t i = 0; i < differs.data.size(); ++i)
        differs.data[i] &= differs_reversed.data[i];
    return differs;
}

void add(ComponentVotes& sum, const ComponentVotes& part) {
    sum.size += part.size;
    sum.picture += part.picture;
    sum.room += part.room;
    sum.sum_x += part.sum_x;
    sum.sum_y += part.sum_y;
}

// Other light or colours also make parts, but with edges along little of their outlines: here along
// half of the shortest outline possible, which has 4 sqrt(size) pixels.
bool is_ghost_all_around(const ComponentVotes& part) {
    return is_clear_ghost(part) && part.room >= 2.0 * std::sqrt(part.size);
}

// The largest part that is a ghost, or else all such parts together: somebody who stands before a
// ghost in the take leaves only pieces of it. Things and cameras that were moved a little make
// pieces, too, but as many with their edge in the take.
std::optional<RoomGhost> choose_ghost(std::span<const ComponentVotes> parts,
                                      const image::Mask& mask) {
    ComponentVotes all;
    ComponentVotes pieces;
    ComponentVotes largest;
    for (const ComponentVotes& part : parts) {
        add(all, part);
        if (!is_ghost_all_around(part)) continue;
        add(pieces, part);
        if (part.size > largest.size) largest = part;
    }
    const ComponentVotes& ghost =
        has_size_of_person(largest.size, mask) || !is_clear_ghost(all) ? largest : pieces;
    if (!has_size_of_person(ghost.size, mask)) return std::nullopt;
    return RoomGhost{static_cast<int>(ghost.sum_x / ghost.size),
                     static_cast<int>(ghost.sum_y / ghost.size)};
}

}  // namespace

SteadyPicture find_steady_picture(std::span<const image::YuvImage> pictures) {
    SteadyPicture result;
    result.is_steady = find_medians(pictures, &image::YuvImage::y, result.picture.y);
    const image::Mask u = find_medians(pictures, &image::YuvImage::u, result.picture.u);
    const image::Mask v = find_medians(pictures, &image::YuvImage::v, result.picture.v);
    for (int y = 0; y < result.is_steady.height; ++y) {
        std::uint8_t* const row = result.is_steady.row(y);
        for (int x = 0; x < result.is_steady.width; ++x)
            row[x] &= u.at(x / 2, y / 2) & v.at(x / 2, y / 2);
    }
    return result;
}

std::optional<RoomGhost> find_ghost(const BackgroundStatistics& room,
                                    const SteadyPicture& take,
                                    const SegmentationOptions& options) {
    auto mask = differing_both_ways(room, take.picture, options);
    if (!mask) return std::nullopt;
    if (2 * std::ranges::count(mask->data, 255) > std::ssize(mask->data)) return std::nullopt;
    for (std::size_t i = 0; i < mask->data.size(); ++i) mask->data[i] &= take.is_steady.data[i];
    ComponentScratch scratch;
    count_votes(take.picture, room, *mask, scratch);
    return choose_ghost(scratch.components, *mask);
}

}  // namespace atrium::segmentation
