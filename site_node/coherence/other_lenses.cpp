#include "site_node/coherence/other_lenses.hpp"

#include "site_node/coherence/camera_fit.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <map>
#include <utility>
#include <vector>

namespace atrium::coherence {
namespace {

constexpr double kStep = 0.03;  // of the logarithm of the factor
constexpr int kSteps = 11;      // in each direction: 0.72 to 1.39
constexpr int kHalvings = 5;
constexpr std::size_t kCoarse = 16;  // sights of the first search
constexpr std::size_t kParts = 4;    // of the window, in time
// What certainty needs.
constexpr double kLeastExplained_px = 0.7;
constexpr double kMuchBetter = 0.7;
constexpr double kBetterInPart = 0.85;
constexpr double kAsManyTangents = 0.8;
// One number fits two pairs of cameras in any case.
constexpr std::size_t kLeastOfPair = 16;
constexpr std::size_t kLeastPairs = 3;

struct Fit {
    double rms_px = 0.0;
    std::vector<double> parts_px;
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::vector<double>> pairs;  // their errors
    std::size_t num_tangents = 0;
};

class Search {
public:
    Search(std::span<const geometry::CalibratedCamera> cameras, std::span<const Sight> sights)
        : cameras_(cameras), sights_(sights) {}

    // `step`: every so many sights count.
    Fit fit(double log_factor, std::size_t step = 1) const {
        std::vector<geometry::CalibratedCamera> cameras(cameras_.begin(), cameras_.end());
        for (geometry::CalibratedCamera& camera : cameras) {
            camera.intrinsics.fx *= std::exp(log_factor);
            camera.intrinsics.fy *= std::exp(log_factor);
        }
        std::vector<Tangency> found;
        for (std::size_t s = 0; s < sights_.size(); s += step)
            find_tangencies(cameras, sights_[s], static_cast<std::uint32_t>(s), {}, found);
        const std::vector<double> dilations = find_dilations(found, cameras.size());
        Fit fit;
        std::vector<double> all;
        std::vector<std::vector<double>> parts(kParts);
        for (const Tangency& t : found) {
            const double error = error_without(t, dilations);
            all.push_back(error);
            fit.pairs[{t.ends[0].camera, t.ends[1].camera}].push_back(error);
            parts[t.sight * kParts / sights_.size()].push_back(error);
        }
        fit.num_tangents = all.size();
        fit.rms_px = robust_deviation(std::move(all));
        for (auto& part : parts) fit.parts_px.push_back(robust_deviation(std::move(part)));
        return fit;
    }

    double best() const {
        const std::size_t step = std::max<std::size_t>(1, sights_.size() / kCoarse);
        double best = 0.0;
        double least_px = fit(0.0, step).rms_px;
        for (int i = -kSteps; i <= kSteps; ++i) {
            const double px = fit(kStep * i, step).rms_px;
            if (px >= least_px) continue;
            least_px = px;
            best = kStep * i;
        }
        least_px = fit(best).rms_px;
        double width = 0.5 * kStep;
        for (int i = 0; i < kHalvings; ++i, width *= 0.5) {
            const double middle = best;
            for (const double tried : {middle - width, middle + width}) {
                const double px = fit(tried).rms_px;
                if (px >= least_px) continue;
                least_px = px;
                best = tried;
            }
        }
        return best;
    }

private:
    std::span<const geometry::CalibratedCamera> cameras_;
    std::span<const Sight> sights_;
};

// How many pairs of cameras have enough tangents to judge, and fit better.
struct Pairs {
    std::size_t num_judged = 0, num_better = 0;
};

Pairs compare_pairs(const Fit& before, const Fit& after) {
    Pairs pairs;
    for (const auto& [pair, errors] : before.pairs) {
        const auto found = after.pairs.find(pair);
        if (errors.size() < kLeastOfPair || found == after.pairs.end()) continue;
        ++pairs.num_judged;
        const double now_px = robust_deviation(found->second);
        pairs.num_better += now_px <= kBetterInPart * robust_deviation(errors) ? 1 : 0;
    }
    return pairs;
}

}  // namespace

std::optional<OtherLenses> find_other_lenses(std::span<const geometry::CalibratedCamera> cameras,
                                             std::span<const Sight> sights) {
    if (sights.size() < kParts) return std::nullopt;
    const Search search(cameras, sights);
    const Fit before = search.fit(0.0);
    if (before.rms_px < kDoubtful_px) return std::nullopt;
    const double best = search.best();
    const Fit after = search.fit(best);
    std::size_t num_better = 0;
    for (std::size_t p = 0; p < kParts; ++p)
        num_better += after.parts_px[p] <= kBetterInPart * before.parts_px[p] ? 1 : 0;
    const Pairs pairs = compare_pairs(before, after);
    const double explained_px =
        std::sqrt(std::max(0.0, before.rms_px * before.rms_px - after.rms_px * after.rms_px));
    if (std::abs(std::expm1(best)) < kOtherFactor || explained_px < kLeastExplained_px ||
        after.rms_px > kMuchBetter * before.rms_px || num_better + 1 < kParts ||
        pairs.num_judged < kLeastPairs || 3 * pairs.num_better < 2 * pairs.num_judged ||
        static_cast<double>(after.num_tangents) <
            kAsManyTangents * static_cast<double>(before.num_tangents))
        return std::nullopt;
    return OtherLenses{std::exp(best), before.rms_px, after.rms_px};
}

}  // namespace atrium::coherence
