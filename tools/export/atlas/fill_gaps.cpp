#include "tools/export/atlas/fill_gaps.hpp"

#include <Eigen/Core>

#include <algorithm>
#include <cstddef>

namespace atrium::exporting {
namespace {

constexpr std::uint8_t kGrey = 128;

// Colours times their weight, and the weight: 1 where known.
struct Level {
    int width = 0;
    int height = 0;
    std::vector<Eigen::Vector4f> texels;

    Eigen::Vector4f& at(int x, int y) {
        return texels[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
                      static_cast<std::size_t>(x)];
    }
};

Level halved(Level& from) {
    Level to{(from.width + 1) / 2, (from.height + 1) / 2, {}};
    to.texels.assign(static_cast<std::size_t>(to.width) * static_cast<std::size_t>(to.height),
                     Eigen::Vector4f::Zero());
    for (int y = 0; y < from.height; ++y) {
        for (int x = 0; x < from.width; ++x) to.at(x / 2, y / 2) += from.at(x, y);
    }
    for (Eigen::Vector4f& texel : to.texels) {
        if (texel.w() > 1.0f) texel /= texel.w();
    }
    return to;
}

// The coarser level at the centre of texel (x, y) of the finer one, bilinear.
Eigen::Vector4f above(Level& coarse, int x, int y) {
    const int x0 = x / 2;
    const int y0 = y / 2;
    const int x1 = std::clamp(x0 + (x % 2 == 0 ? -1 : 1), 0, coarse.width - 1);
    const int y1 = std::clamp(y0 + (y % 2 == 0 ? -1 : 1), 0, coarse.height - 1);
    return 0.5625f * coarse.at(x0, y0) + 0.1875f * (coarse.at(x1, y0) + coarse.at(x0, y1)) +
           0.0625f * coarse.at(x1, y1);
}

}  // namespace

void fill_gaps(const std::vector<std::uint8_t>& is_known, Picture& picture) {
    if (std::ranges::all_of(is_known, [](std::uint8_t known) { return known == 0; })) {
        std::ranges::fill(picture.rgba, kGrey);
        for (std::size_t i = 3; i < picture.rgba.size(); i += 4) picture.rgba[i] = 255;
        return;
    }
    std::vector<Level> levels(1);
    levels[0] = {picture.width, picture.height, {}};
    levels[0].texels.assign(is_known.size(), Eigen::Vector4f::Zero());
    for (std::size_t i = 0; i < is_known.size(); ++i) {
        const std::uint8_t* from = picture.rgba.data() + 4 * i;
        if (is_known[i] != 0)
            levels[0].texels[i] = {float(from[0]), float(from[1]), float(from[2]), 1.0f};
    }
    while (levels.back().width > 1 || levels.back().height > 1)
        levels.push_back(halved(levels.back()));
    for (std::size_t i = levels.size() - 1; i-- > 0;) {
        Level& fine = levels[i];
        for (int y = 0; y < fine.height; ++y) {
            for (int x = 0; x < fine.width; ++x) {
                Eigen::Vector4f& texel = fine.at(x, y);
                if (texel.w() < 1.0f) texel += (1.0f - texel.w()) * above(levels[i + 1], x, y);
            }
        }
    }
    for (std::size_t i = 0; i < is_known.size(); ++i) {
        std::uint8_t* to = picture.rgba.data() + 4 * i;
        to[3] = 255;
        if (is_known[i] != 0) continue;
        for (int c = 0; c < 3; ++c) {
            to[c] =
                static_cast<std::uint8_t>(std::clamp(levels[0].texels[i][c], 0.0f, 255.0f) + 0.5f);
        }
    }
}

}  // namespace atrium::exporting
