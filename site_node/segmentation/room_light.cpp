#include "site_node/segmentation/room_light.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

namespace atrium::segmentation {
namespace {

constexpr int kStep = 16;  // from place to place [px]
constexpr std::size_t kFewestPlaces = 8;
constexpr double kSmallestLuma = 8.0;  // for ratios: below it all is noise
// By so much half of the places may brighten or darken: more than SegmentationOptions::
// max_gain_change compensates, and the rest of the light then counts as highlight or shadow.
constexpr double kMostBrighter = 1.35;
constexpr double kMostDarker = 1.35;
constexpr double kLeastDifference = 10.0;  // of half of the places: a dark room is mostly noise
// Squares of the picture, compared by what they show, whatever the light.
constexpr int kSquare = 32;       // [px]
constexpr int kSquareStep = 48;   // from square to square
constexpr double kTexture = 5.0;  // deviation of luma from which a square shows something
constexpr double kAlike = 0.4;    // correlation
constexpr std::size_t kFewestSquares = 12;
constexpr double kMostOther = 0.65;  // of the squares: people hide fewer
constexpr double kNoiseRange = 2.0;
constexpr double kPlainRange = 6.0;  // in the light of the pictures
constexpr double kRichRange = 24.0;
constexpr double kNearLuma = 12.0;
constexpr double kFewNear = 1.0 / 3.0;  // of the places

void sample(std::span<const std::uint16_t> room_luma,
            const image::PlaneView& picture,
            LightScratch& places) {
    places.room.clear();
    places.picture.clear();
    for (int y = kStep / 2; y + 1 < picture.height; y += kStep) {
        for (int x = kStep / 2; x + 1 < picture.width; x += kStep) {
            const auto at = static_cast<std::size_t>(y) * static_cast<std::size_t>(picture.width) +
                            static_cast<std::size_t>(x);
            const auto below = at + static_cast<std::size_t>(picture.width);
            places.room.push_back(
                (room_luma[at] + room_luma[at + 1] + room_luma[below] + room_luma[below + 1]) /
                1024.0);
            places.picture.push_back((picture.at(x, y) + picture.at(x + 1, y) +
                                      picture.at(x, y + 1) + picture.at(x + 1, y + 1)) /
                                     4.0);
        }
    }
}

double quantile(const std::vector<double>& values, double share, std::vector<double>& sorted) {
    sorted.assign(values.begin(), values.end());
    const auto at = sorted.begin() +
                    static_cast<std::ptrdiff_t>(share * static_cast<double>(sorted.size() - 1));
    std::ranges::nth_element(sorted, at);
    return *at;
}

// Without the tenth of the places at either end.
double range_of(const std::vector<double>& values, std::vector<double>& sorted) {
    return quantile(values, 0.9, sorted) - quantile(values, 0.1, sorted);
}

// No picture of a room, unless most of the pictures show it, as in a room that is plain itself.
// `ratio`: of the pictures to the room; a dark room has small ranges.
bool is_plain(LightScratch& places, double ratio) {
    const double range = range_of(places.room, places.sorted);
    const bool has_content = range >= kNoiseRange && range * std::max(ratio, 1.0) >= kPlainRange;
    if (has_content || range_of(places.picture, places.sorted) <= kRichRange) return false;
    double num_near = 0.0;
    for (std::size_t i = 0; i < places.room.size(); ++i)
        num_near += std::abs(places.room[i] - places.picture[i]) <= kNearLuma ? 1.0 : 0.0;
    return num_near < kFewNear * static_cast<double>(places.room.size());
}

// Correlation of a square of both, from sums of 2x2 pixels; nullopt if the room has no texture
// there.
std::optional<double> likeness_of(std::span<const std::uint16_t> room_luma,
                                  const image::PlaneView& picture,
                                  int left,
                                  int top) {
    double n = 0.0;
    double a = 0.0;
    double b = 0.0;
    double aa = 0.0;
    double bb = 0.0;
    double ab = 0.0;
    for (int y = top; y < top + kSquare; y += 2) {
        const std::uint16_t* const room =
            room_luma.data() + static_cast<std::ptrdiff_t>(y) * picture.width;
        const std::uint16_t* const below = room + picture.width;
        for (int x = left; x < left + kSquare; x += 2) {
            const double of_room = (room[x] + room[x + 1] + below[x] + below[x + 1]) / 1024.0;
            const double of_picture = (picture.at(x, y) + picture.at(x + 1, y) +
                                       picture.at(x, y + 1) + picture.at(x + 1, y + 1)) /
                                      4.0;
            n += 1.0;
            a += of_room;
            b += of_picture;
            aa += of_room * of_room;
            bb += of_picture * of_picture;
            ab += of_room * of_picture;
        }
    }
    const double variance_a = aa / n - a / n * a / n;
    const double variance_b = bb / n - b / n * b / n;
    if (variance_a < kTexture * kTexture) return std::nullopt;
    return (ab / n - a / n * b / n) / std::sqrt(variance_a * std::max(variance_b, 1.0));
}

bool is_other_view(std::span<const std::uint16_t> room_luma, const image::PlaneView& picture) {
    std::size_t num = 0;
    std::size_t num_other = 0;
    for (int y = 0; y + kSquare <= picture.height; y += kSquareStep) {
        for (int x = 0; x + kSquare <= picture.width; x += kSquareStep) {
            const auto likeness = likeness_of(room_luma, picture, x, y);
            if (!likeness) continue;
            ++num;
            num_other += *likeness < kAlike ? 1 : 0;
        }
    }
    return num >= kFewestSquares &&
           static_cast<double>(num_other) > kMostOther * static_cast<double>(num);
}

}  // namespace

std::optional<std::string> doubt_of_light(std::span<const std::uint16_t> room_luma,
                                          const image::PlaneView& picture_luma,
                                          LightScratch& scratch) {
    if (room_luma.size() != static_cast<std::size_t>(picture_luma.width) *
                                static_cast<std::size_t>(picture_luma.height))
        return std::nullopt;
    sample(room_luma, picture_luma, scratch);
    if (scratch.room.size() < kFewestPlaces) return std::nullopt;
    scratch.ratios.clear();
    scratch.differences.clear();
    for (std::size_t i = 0; i < scratch.room.size(); ++i) {
        const double room = scratch.room[i];
        const double picture = scratch.picture[i];
        scratch.differences.push_back(picture - room);
        scratch.ratios.push_back(std::max(picture, kSmallestLuma) / std::max(room, kSmallestLuma));
    }
    const double ratio = quantile(scratch.ratios, 0.5, scratch.sorted);
    const double difference = quantile(scratch.differences, 0.5, scratch.sorted);
    const bool is_brighter = ratio > kMostBrighter && difference > kLeastDifference;
    const bool is_darker = ratio * kMostDarker < 1.0 && difference < -kLeastDifference;
    if (is_plain(scratch, ratio))
        return fmt::format("is one plain grey ({:.0f} of 255)",
                           quantile(scratch.room, 0.5, scratch.sorted));
    if (is_brighter) return fmt::format("is {:.1f} times darker than the pictures", ratio);
    if (is_darker) return fmt::format("is {:.1f} times brighter than the pictures", 1.0 / ratio);
    if (is_other_view(room_luma, picture_luma))
        return "shows another view: the camera moved or was set otherwise since, or it is another "
               "room";
    return std::nullopt;
}

}  // namespace atrium::segmentation
