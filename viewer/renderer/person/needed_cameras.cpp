#include "viewer/renderer/person/needed_cameras.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <numeric>

namespace atrium::renderer {
namespace {

float cos_between(const Eigen::Vector3f& a, const Eigen::Vector3f& b) {
    return a.dot(b) / std::sqrt(std::max(a.squaredNorm() * b.squaredNorm(), 1e-12F));
}

}  // namespace

std::vector<bool> needed_cameras(std::span<const Eigen::Vector3f> centres_site,
                                 const Eigen::AlignedBox3f& bounds_site,
                                 std::span<const Eigen::Vector3f> eyes_site,
                                 const NeededCamerasOptions& options) {
    const std::size_t num = centres_site.size();
    const auto is_inside = [&](const Eigen::Vector3f& eye) { return bounds_site.contains(eye); };
    if (eyes_site.empty() || bounds_site.isEmpty() || std::ranges::any_of(eyes_site, is_inside))
        return std::vector<bool>(num, true);
    const auto least_cos =
        static_cast<float>(std::cos(options.max_angle_deg * std::numbers::pi / 180.0));
    std::vector<bool> needed(num, false);
    std::vector<float> cosines(num);
    std::vector<std::size_t> order(num);
    for (const Eigen::Vector3f& eye : eyes_site) {
        for (std::size_t c = 0; c < num; ++c) {
            // smallest angle over centre and corners of the bounds
            cosines[c] =
                cos_between(centres_site[c] - bounds_site.center(), eye - bounds_site.center());
            for (int i = 0; i < 8; ++i) {
                const Eigen::Vector3f p =
                    bounds_site.corner(static_cast<Eigen::AlignedBox3f::CornerType>(i));
                cosines[c] = std::max(cosines[c], cos_between(centres_site[c] - p, eye - p));
            }
            if (cosines[c] >= least_cos) needed[c] = true;
        }
        std::iota(order.begin(), order.end(), std::size_t{0});
        const std::size_t least_num = std::min(options.least_num, num);
        std::ranges::partial_sort(order,
                                  order.begin() + static_cast<std::ptrdiff_t>(least_num),
                                  std::ranges::greater{},
                                  [&](std::size_t c) { return cosines[c]; });
        for (std::size_t i = 0; i < least_num; ++i) needed[order[i]] = true;
    }
    return needed;
}

}  // namespace atrium::renderer
