#include "site_node/segmentation/view_shift.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <functional>
#include <numeric>
#include <utility>

namespace atrium::segmentation {
namespace {

constexpr int kHalf = 2;        // pixels per pixel of a small picture
constexpr int kQuarter = 4;     // likewise
constexpr int kPatchSide = 12;  // side of a square in a quarter of the picture
constexpr int kReach = 19;      // of the coarse search, in a quarter of the picture
constexpr int kFineReach = 3;   // in half of the picture
constexpr std::size_t kMostPatches = 24;
constexpr std::size_t kFewestPatches = 12;
constexpr float kPatchTexture = 3.0f;  // deviation of luma from which a square shows something
constexpr double kExplains = 0.6;      // mean likeness at the shift
constexpr double kPeakOver = 0.03;     // than at any other shift that is not beside it
constexpr int kBeside = 2;

using Squares = std::vector<ViewScratch::Square>;

template <typename SumAt>
void shrink(int width, int height, const SumAt& sum_at, SmallPicture& small) {
    small.width = width / 2;
    small.height = height / 2;
    small.luma.resize(static_cast<std::size_t>(small.width) *
                      static_cast<std::size_t>(small.height));
    float* out = small.luma.data();
    for (int y = 0; y < small.height; ++y) {
        for (int x = 0; x < small.width; ++x) *out++ = sum_at(2 * x, 2 * y) / 4.0f;
    }
}

void shrink(const SmallPicture& picture, SmallPicture& small) {
    const auto sum_at = [&](int x, int y) {
        const float* const at =
            picture.luma.data() + static_cast<std::ptrdiff_t>(y) * picture.width + x;
        return at[0] + at[1] + at[picture.width] + at[picture.width + 1];
    };
    shrink(picture.width, picture.height, sum_at, small);
}

struct Moments {
    float mean = 0.0f;
    float variance = 0.0f;
};

Moments moments_of(const SmallPicture& picture, int left, int top, int side) {
    float sum = 0.0f;
    float squares = 0.0f;
    for (int y = top; y < top + side; ++y) {
        const float* const row =
            picture.luma.data() + static_cast<std::ptrdiff_t>(y) * picture.width + left;
        for (int x = 0; x < side; ++x) {
            sum += row[x];
            squares += row[x] * row[x];
        }
    }
    const float num = static_cast<float>(side) * static_cast<float>(side);
    const float mean = sum / num;
    return {mean, std::max(squares / num - mean * mean, 0.0f)};
}

// The squares with the most texture. All shifts stay within the picture.
void choose_squares(const SmallPicture& quarter, Squares& squares) {
    constexpr int kMargin = kReach + kFineReach;
    squares.clear();
    for (int y = kMargin; y + kPatchSide + kMargin <= quarter.height; y += kPatchSide) {
        for (int x = kMargin; x + kPatchSide + kMargin <= quarter.width; x += kPatchSide) {
            const float variance = moments_of(quarter, x, y, kPatchSide).variance;
            if (variance >= kPatchTexture * kPatchTexture) squares.push_back({x, y, variance});
        }
    }
    if (squares.size() <= kMostPatches) return;
    std::ranges::nth_element(
        squares, squares.begin() + kMostPatches, std::greater{}, &ViewScratch::Square::variance);
    squares.resize(kMostPatches);
}

// One size of both pictures; `scale`: of its pixels to a quarter's.
struct Level {
    struct Patch {
        int left, top;
        float mean, deviation;  // of the room
    };

    Level(const SmallPicture& of_room,
          const SmallPicture& of_picture,
          int at_scale,
          const Squares& squares)
        : room(of_room), picture(of_picture), side(at_scale * kPatchSide) {
        for (std::size_t i = 0; i < squares.size(); ++i) {
            const int left = at_scale * squares[i].x;
            const int top = at_scale * squares[i].y;
            const Moments here = moments_of(room, left, top, side);
            patches[i] = {left, top, here.mean, std::sqrt(std::max(here.variance, 1.0f))};
        }
        num_patches = squares.size();
    }

    // Mean correlation of the squares of the room with the picture's at a shift, without the
    // squares that fit worst: people hide them.
    double likeness_at(int shift_x, int shift_y) const {
        const float num = static_cast<float>(side) * static_cast<float>(side);
        std::array<float, kMostPatches> likeness{};
        std::size_t num_done = 0;
        for (const Patch& patch : std::span(patches).first(num_patches)) {
            float of_there = 0.0f;
            float squares = 0.0f;
            float product = 0.0f;
            for (int y = patch.top; y < patch.top + side; ++y) {
                const float* const a =
                    room.luma.data() + static_cast<std::ptrdiff_t>(y) * room.width + patch.left;
                const float* const b = picture.luma.data() +
                                       static_cast<std::ptrdiff_t>(y + shift_y) * picture.width +
                                       patch.left + shift_x;
                for (int x = 0; x < side; ++x) {
                    of_there += b[x];
                    squares += b[x] * b[x];
                    product += (a[x] - patch.mean) * b[x];
                }
            }
            const float mean = of_there / num;
            const float variance = std::max(squares / num - mean * mean, 1.0f);
            likeness[num_done++] = product / num / (patch.deviation * std::sqrt(variance));
        }
        const std::size_t num_hidden = num_patches * 2 / 5;
        const auto first_seen = likeness.begin() + static_cast<std::ptrdiff_t>(num_hidden);
        const auto end = likeness.begin() + static_cast<std::ptrdiff_t>(num_patches);
        std::nth_element(likeness.begin(), first_seen, end);
        return std::accumulate(first_seen, end, 0.0) /
               static_cast<double>(num_patches - num_hidden);
    }

    const SmallPicture& room;
    const SmallPicture& picture;
    int side;
    std::array<Patch, kMostPatches> patches{};
    std::size_t num_patches = 0;
};

// Whether the squares fit best where they are: the usual case, found with few comparisons.
bool fits_unshifted(const Level& level) {
    const double here = level.likeness_at(0, 0);
    if (here < kExplains) return false;
    for (const auto& [x, y] : {std::pair{1, 0}, {-1, 0}, {0, 1}, {0, -1}})
        if (level.likeness_at(x, y) > here) return false;
    return true;
}

struct Peak {
    Eigen::Vector2d shift;  // [px of the level]
    double likeness = 0.0;
    bool is_inside = false;  // of the reach
    bool is_alone = true;
};

// Of a parabola through three values around the largest.
double vertex_of(double before, double at, double after) {
    const double bend = before - 2.0 * at + after;
    return bend < 0.0 ? std::clamp(0.5 * (before - after) / bend, -0.5, 0.5) : 0.0;
}

Peak find_peak(const Level& level,
               const Eigen::Vector2i& middle,
               int reach,
               std::vector<double>& likeness) {
    const int side = 2 * reach + 1;
    likeness.assign(static_cast<std::size_t>(side) * static_cast<std::size_t>(side), 0.0);
    const auto at = [&](int x, int y) -> double& {
        return likeness[static_cast<std::size_t>((y + reach) * side + x + reach)];
    };
    int best_x = 0;
    int best_y = 0;
    for (int y = -reach; y <= reach; ++y) {
        for (int x = -reach; x <= reach; ++x) {
            at(x, y) = level.likeness_at(middle.x() + x, middle.y() + y);
            if (at(x, y) <= at(best_x, best_y)) continue;
            best_x = x;
            best_y = y;
        }
    }
    Peak peak{(middle + Eigen::Vector2i(best_x, best_y)).cast<double>(), at(best_x, best_y)};
    if (std::max(std::abs(best_x), std::abs(best_y)) == reach) return peak;
    peak.shift +=
        Eigen::Vector2d(vertex_of(at(best_x - 1, best_y), peak.likeness, at(best_x + 1, best_y)),
                        vertex_of(at(best_x, best_y - 1), peak.likeness, at(best_x, best_y + 1)));
    peak.is_inside = true;
    for (int y = -reach; y <= reach; ++y) {
        for (int x = -reach; x <= reach; ++x) {
            const bool is_beside =
                std::abs(x - best_x) <= kBeside && std::abs(y - best_y) <= kBeside;
            if (!is_beside && at(x, y) > peak.likeness - kPeakOver) peak.is_alone = false;
        }
    }
    return peak;
}

}  // namespace

std::optional<Eigen::Vector2d> find_view_shift(std::span<const std::uint16_t> room_luma,
                                               const image::PlaneView& picture_luma,
                                               ViewScratch& scratch) {
    const int width = picture_luma.width;
    const int height = picture_luma.height;
    if (room_luma.size() != static_cast<std::size_t>(width) * static_cast<std::size_t>(height))
        return std::nullopt;
    const auto of_room = [&](int x, int y) {
        const std::uint16_t* const at =
            room_luma.data() + static_cast<std::ptrdiff_t>(y) * width + x;
        return static_cast<float>(at[0] + at[1] + at[width] + at[width + 1]) / 256.0f;
    };
    const auto of_picture = [&](int x, int y) {
        return static_cast<float>(picture_luma.at(x, y) + picture_luma.at(x + 1, y) +
                                  picture_luma.at(x, y + 1) + picture_luma.at(x + 1, y + 1));
    };
    shrink(width, height, of_room, scratch.half_room);
    shrink(scratch.half_room, scratch.quarter_room);
    choose_squares(scratch.quarter_room, scratch.squares);
    if (scratch.squares.size() < kFewestPatches) return std::nullopt;
    shrink(width, height, of_picture, scratch.half_picture);
    constexpr int kFineScale = kQuarter / kHalf;
    const Level fine(scratch.half_room, scratch.half_picture, kFineScale, scratch.squares);
    if (fits_unshifted(fine)) return std::nullopt;
    const auto find_near = [&](const Eigen::Vector2i& middle) {
        return find_peak(fine, middle, kFineReach, scratch.likeness);
    };
    Peak peak = find_near(Eigen::Vector2i::Zero());
    if (!peak.is_inside || peak.likeness < kExplains) {
        shrink(scratch.half_picture, scratch.quarter_picture);
        const Level coarse(scratch.quarter_room, scratch.quarter_picture, 1, scratch.squares);
        const Peak far = find_peak(coarse, Eigen::Vector2i::Zero(), kReach, scratch.likeness);
        if (!far.is_inside || !far.is_alone || far.likeness < kExplains) return std::nullopt;
        peak = find_near((kFineScale * far.shift).array().round().matrix().cast<int>());
        if (!peak.is_inside || peak.likeness < kExplains) return std::nullopt;
    }
    const Eigen::Vector2d shift = kHalf * peak.shift;
    return shift.norm() < kLeastShift_px ? std::nullopt : std::optional(shift);
}

}  // namespace atrium::segmentation
