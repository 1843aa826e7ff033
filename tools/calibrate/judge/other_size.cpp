#include "tools/calibrate/judge/other_size.hpp"

#include "core/base/median.hpp"

#include <algorithm>
#include <cmath>

namespace atrium::calibrate {
namespace {

// Twice a principal point, as a share of the picture, strays by less than this share of the rig's.
constexpr double kStrays = 0.2;
// Common factors begin at 1.2 (1920 to 1600 px). No camera may have a factor of about 1.
constexpr double kClearlyOther = 1.15;
constexpr double kAboutOne = 1.05;
constexpr double kLargestFactor = 16.0;  // beyond that the principal point has another unit
constexpr double kNearlyAll = 0.8;
// Pictures are mostly scaled by a ratio of small numbers. The factor is good to about 2 %.
constexpr int kLargestOfRatio = 6;
constexpr double kIsRatio = 0.05;
constexpr double kFactorError = 0.02;

using Factors = std::array<double, 2>;  // of width and height

// The likeliest ratio of small numbers, where smaller ones are likelier; else `factor`.
double likely_ratio(double factor) {
    double best = factor;
    double lowest_cost = 1e9;
    for (int p = 1; p <= kLargestOfRatio; ++p) {
        for (int q = 1; q <= kLargestOfRatio; ++q) {
            const double ratio = static_cast<double>(p) / q;
            const double off = std::abs(ratio / factor - 1.0);
            const double cost = std::pow(off / kFactorError, 2) + 0.5 * (p + q);
            if (off > kIsRatio || cost >= lowest_cost) continue;
            lowest_cost = cost;
            best = ratio;
        }
    }
    return best;
}

bool agrees_with(double median, const Factors& of_camera) {
    return std::ranges::all_of(of_camera, [&](double factor) {
        return std::abs(factor / median - 1.0) <= kStrays &&
               (median > 1.0 ? factor > kAboutOne : factor * kAboutOne < 1.0);
    });
}

}  // namespace

std::optional<OtherSize> find_other_size(std::span<const geometry::CalibratedCamera> cameras) {
    if (cameras.size() < 2) return std::nullopt;
    std::vector<Factors> factors;  // by camera
    std::vector<double> all;
    for (const auto& camera : cameras) {
        const geometry::PinholeCamera& k = camera.intrinsics;
        factors.push_back({2.0 * (k.cx + 0.5) / k.width, 2.0 * (k.cy + 0.5) / k.height});
        all.insert(all.end(), factors.back().begin(), factors.back().end());
    }
    const double median = median_of(all);
    if (!(median > 1.0 / kLargestFactor && median < kLargestFactor) ||
        std::max(median, 1.0 / median) < kClearlyOther)
        return std::nullopt;
    OtherSize result;
    double sum = 0.0;
    for (const Factors& of_camera : factors) {
        const bool agrees = agrees_with(median, of_camera);
        result.agrees.push_back(agrees);
        if (!agrees) continue;
        ++result.num_agreeing;
        sum += of_camera[0] + of_camera[1];
    }
    if (result.num_agreeing < 2 ||
        static_cast<double>(result.num_agreeing) < kNearlyAll * static_cast<double>(cameras.size()))
        return std::nullopt;
    result.factor = likely_ratio(0.5 * sum / static_cast<double>(result.num_agreeing));
    const geometry::PinholeCamera& first = cameras.front().intrinsics;
    if (std::ranges::all_of(cameras, [&](const auto& camera) {
            return camera.intrinsics.width == first.width &&
                   camera.intrinsics.height == first.height;
        })) {
        result.size = {static_cast<int>(std::lround(result.factor * first.width)),
                       static_cast<int>(std::lround(result.factor * first.height))};
    }
    return result;
}

}  // namespace atrium::calibrate
