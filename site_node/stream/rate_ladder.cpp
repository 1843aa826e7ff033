#include "site_node/stream/rate_ladder.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <utility>

namespace atrium::stream {
namespace {

constexpr std::array kQualities{75, 65, 50, 40};
constexpr int kMaxSendEvery = 6;
constexpr int kHalfQualityAtMost = 75;

// Colour bytes at a JPEG quality, relative to 85: the initial guess for the learned ratios.
double size_at_quality(int quality) {
    constexpr std::array<std::pair<int, double>, 8> kTable{{{1, 0.08},
                                                            {20, 0.26},
                                                            {40, 0.42},
                                                            {50, 0.49},
                                                            {65, 0.62},
                                                            {75, 0.76},
                                                            {85, 1.0},
                                                            {100, 3.5}}};
    const auto above = std::find_if(kTable.begin() + 1, kTable.end() - 1, [&](const auto& row) {
        return row.first >= quality;
    });
    const auto below = above - 1;
    const double share = static_cast<double>(quality - below->first) /
                         static_cast<double>(above->first - below->first);
    return below->second + share * (above->second - below->second);
}

// A half-size picture has a quarter of the pixels, but they are less smooth.
constexpr double kSizeAtHalf = 0.33;

double first_guess(const Level& level) {
    return size_at_quality(level.jpeg_quality) * (level.colour_divisor == 2 ? kSizeAtHalf : 1.0);
}

}  // namespace

std::vector<Level> make_ladder(int jpeg_quality) {
    assert(jpeg_quality >= 1 && jpeg_quality <= 100);
    const auto qualities_from = [](int best) {
        std::vector<int> qualities{best};
        for (const int quality : kQualities) {
            if (quality < best) qualities.push_back(quality);
        }
        return qualities;
    };
    const std::vector<int> half = qualities_from(std::min(jpeg_quality, kHalfQualityAtMost));
    std::vector<Level> ladder;
    for (const int quality : qualities_from(jpeg_quality)) ladder.push_back({quality, 1, 1});
    for (const int quality : half) ladder.push_back({quality, 2, 1});
    // half the rate leaves room for quality; from there on each step is small
    for (const int quality : half) ladder.push_back({quality, 2, 2});
    for (int n = 3; n <= kMaxSendEvery; ++n) ladder.push_back({half.back(), 2, n});
    return ladder;
}

SizeModel::SizeModel(const std::vector<Level>& ladder) {
    const double best = first_guess(ladder.front());
    for (std::size_t i = 0; i < ladder.size(); ++i) {
        const auto same = std::find_if(ladder.begin(), ladder.end(), [&](const Level& other) {
            return other.jpeg_quality == ladder[i].jpeg_quality &&
                   other.colour_divisor == ladder[i].colour_divisor;
        });
        coding_.push_back(static_cast<std::size_t>(same - ladder.begin()));
        ratio_.push_back(first_guess(ladder[i]) / best);
    }
}

void SizeModel::add(std::size_t level, const FrameBytes& bytes) {
    if (bytes.colour == 0) return;
    constexpr double kFollow = 0.2;  // sees half of a change after 3 frames
    constexpr int kToLearn = 6;      // frames after a change of level that teach its ratio
    const std::size_t coding = coding_[level];
    const auto colour = static_cast<double>(bytes.colour);
    const auto fixed = static_cast<double>(bytes.fixed);
    if (!has_seen_) {
        has_seen_ = true;
        fixed_ = fixed;
        colour_at_best_ = colour / ratio_[coding];
        last_coding_ = coding;
        num_since_change_ = kToLearn;
        return;
    }
    fixed_ += kFollow * (fixed - fixed_);
    if (coding != last_coding_) num_since_change_ = 0;
    last_coding_ = coding;
    // The scene changes little between frames: right after a change of level a difference is due to
    // the level, later to the scene.
    if (coding != 0 && num_since_change_++ < kToLearn) {
        constexpr double kLearn = 0.4;
        ratio_[coding] += kLearn * (colour / colour_at_best_ - ratio_[coding]);
        ratio_[coding] = std::clamp(ratio_[coding], 0.01, 1.0);
        return;
    }
    colour_at_best_ += kFollow * (colour / ratio_[coding] - colour_at_best_);
}

double SizeModel::frame_bytes(std::size_t level) const {
    return fixed_ + ratio_[coding_[level]] * colour_at_best_;
}

}  // namespace atrium::stream
