#include "site_node/refine/colour_clash.hpp"

#include "core/image/colour_clash.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>

namespace atrium::refine {

std::optional<Eigen::Vector3f> colour_at(const PictureView& view,
                                         const LumaPicture& luma,
                                         const Eigen::Vector2f& place) {
    constexpr int kReach = 1;
    constexpr int kFewest = 3;
    if (!(place.x() >= kReach && place.y() >= kReach &&
          place.x() < static_cast<float>(luma.width - 1 - kReach) &&
          place.y() < static_cast<float>(luma.height - 1 - kReach)))
        return std::nullopt;
    const int middle_x = static_cast<int>(place.x() + 0.5F);
    const int middle_y = static_cast<int>(place.y() + 0.5F);
    Eigen::Vector3f sum = Eigen::Vector3f::Zero();
    int num = 0;
    for (int y = middle_y - kReach; y <= middle_y + kReach; ++y) {
        for (int x = middle_x - kReach; x <= middle_x + kReach; ++x) {
            const int block_x = luma.first_x + x;
            const int block_y = luma.first_y + y;
            if (view.mask->at(2 * block_x, 2 * block_y) == 0 ||
                view.mask->at(2 * block_x + 1, 2 * block_y + 1) == 0)
                continue;
            const std::size_t at =
                static_cast<std::size_t>(y) * static_cast<std::size_t>(luma.width) +
                static_cast<std::size_t>(x);
            sum += Eigen::Vector3f(static_cast<float>(luma.taps[at] & 0xFFU),
                                   static_cast<float>(view.picture.u.at(block_x, block_y)),
                                   static_cast<float>(view.picture.v.at(block_x, block_y)));
            ++num;
        }
    }
    if (num < kFewest) return std::nullopt;
    return Eigen::Vector3f(sum / static_cast<float>(num));
}

float colour_clash(std::span<const Eigen::Vector3f> colours) {
    float most = 0.0F;
    for (std::size_t i = 0; i < colours.size(); ++i) {
        for (std::size_t k = i + 1; k < colours.size(); ++k) {
            most = std::max(most, image::colour_clash(colours[i], colours[k]));
        }
    }
    return most;
}

}  // namespace atrium::refine
