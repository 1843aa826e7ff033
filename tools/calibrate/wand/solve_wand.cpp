#include "tools/calibrate/wand/solve_wand.hpp"

#include "tools/calibrate/adjust/bootstrap.hpp"
#include "tools/calibrate/adjust/place_wands.hpp"
#include "tools/calibrate/wand/find_lights.hpp"
#include "tools/calibrate/wand/lateness.hpp"
#include "tools/calibrate/wand/measure_wand.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>

namespace atrium::calibrate {
namespace {

constexpr double kOutlierSigmas = 5.0;
constexpr double kLeastOutlier_px = 0.5;
constexpr double kRobustSigmas = 3.0;
constexpr double kSearchSigmas = 10.0;  // around the place of a light, for its point
constexpr int kHeldOutOf = 5;
constexpr std::size_t kSomeInstants = 1200;  // are enough for a first solution
constexpr double kDoubtfulLate = 0.1;        // instants
constexpr std::size_t kDoubtfulPart = 4;     // an outlier for so many lights that fit

class Solver {
public:
    Solver(const Wand& wand, const std::vector<NominalCamera>& nominal, const WandOptions& options)
        : options_(options) {
        solution_.bundle.wand = wand;
        solution_.cameras.resize(nominal.size());
        for (const NominalCamera& camera : nominal) {
            BundleCamera made;
            made.name = camera.name;
            made.width = camera.width;
            made.height = camera.height;
            made.lens[0] = camera.focal_px > 0.0 ? camera.focal_px : camera.width;
            made.lens[1] = 0.5 * (camera.width - 1);
            made.lens[2] = 0.5 * (camera.height - 1);
            nominal_.push_back(made);
        }
        solution_.bundle.cameras = nominal_;
    }

    Expected<WandSolution> solve(const LightPoints& points) {
        report("labelling lights");
        if (const auto done = find_lights(points, solution_); !done)
            return tl::unexpected(done.error());
        Bundle& bundle = solution_.bundle;
        if (const auto done = bootstrap(bundle, {options_.num_threads, options_.report}); !done)
            return tl::unexpected(done.error());
        ranges_ = ranges_of(bundle);
        report("adjusting all cameras");
        if (const auto done = adjust_some(bundle, LensFreedom::kRadial); !done)
            return tl::unexpected(done.error());
        mark_outliers(bundle);
        for (int round = 0; round < 2; ++round) {
            const auto done =
                round == 0 ? adjust_some(bundle, options_.lens) : adjust_all(bundle, options_.lens);
            if (!done) return tl::unexpected(done.error());
            if (round == 0) {
                const double most_px = kSearchSigmas * std::max(sigma_, kLeastOutlier_px);
                find_lights_at_places(points, most_px, solution_);
                ranges_ = ranges_of(bundle);
            }
            mark_outliers(bundle);
        }
        report("checking with a fifth of the lights");
        if (const auto done = hold_out(); !done) return tl::unexpected(done.error());
        measure_wand(solution_);
        search_lateness();
        return std::move(solution_);
    }

private:
    void report(const std::string& text) const {
        if (options_.report) options_.report(text);
    }

    AdjustOptions adjustment_of(LensFreedom lens) const {
        AdjustOptions adjustment;
        adjustment.lens = lens;
        adjustment.robust_px = kRobustSigmas * std::max(sigma_, 0.05);
        adjustment.num_threads = options_.num_threads;
        return adjustment;
    }

    Expected<void> adjust_all(Bundle& bundle, LensFreedom lens) const {
        return adjust(bundle, adjustment_of(lens));
    }

    // For a first solution. Of many instants, the cameras are adjusted to a part, spread evenly,
    // and the wands of all then to the cameras: that takes a fraction of the time.
    Expected<void> adjust_some(Bundle& bundle, LensFreedom lens) const {
        const std::size_t step = bundle.wands.size() / kSomeInstants + 1;
        if (step == 1) return adjust_all(bundle, lens);
        Bundle some = bundle;
        for (Sighting& sighting : some.sightings)
            if (sighting.instant % step != 0) sighting.is_used = false;
        for (std::size_t i = 0; i < some.wands.size(); ++i)
            if (i % step != 0) some.wands[i].is_placed = false;
        if (const auto done = adjust_all(some, lens); !done) return done;
        bundle.cameras = std::move(some.cameras);
        AdjustOptions adjustment = adjustment_of(LensFreedom::kFixed);
        adjustment.are_cameras_fixed = true;
        return adjust(bundle, adjustment);
    }

    void mark_outliers(Bundle& bundle) {
        std::vector<double> errors;
        for (const Sighting& sighting : bundle.sightings) {
            if (!sighting.is_used) continue;
            const Eigen::Vector2d error = error_px(bundle, sighting);
            errors.insert(errors.end(), {std::abs(error.x()), std::abs(error.y())});
        }
        if (errors.empty()) return;
        const auto middle = errors.begin() + static_cast<std::ptrdiff_t>(errors.size() / 2);
        std::nth_element(errors.begin(), middle, errors.end());
        sigma_ = 1.4826 * *middle;
        for (Sighting& sighting : bundle.sightings)
            sighting.is_used = is_inlier(error_px(bundle, sighting));
        drop_lonely(bundle);
    }

    bool is_inlier(const Eigen::Vector2d& error) const {
        return error.norm() <= std::max(kLeastOutlier_px, kOutlierSigmas * sigma_);
    }

    // A wand that one camera sees alone says nothing, and may be anywhere.
    void drop_lonely(Bundle& bundle) const {
        for (std::size_t i = 0; i < ranges_.size(); ++i) {
            std::uint32_t first = UINT32_MAX;
            bool is_lonely = true;
            for (std::size_t s = ranges_[i].begin; s < ranges_[i].end; ++s) {
                const Sighting& sighting = bundle.sightings[s];
                if (!sighting.is_used) continue;
                is_lonely = is_lonely && (first == UINT32_MAX || first == sighting.camera);
                first = sighting.camera;
            }
            if (!is_lonely) continue;
            bundle.wands[i].is_placed = false;
            for (std::size_t s = ranges_[i].begin; s < ranges_[i].end; ++s)
                bundle.sightings[s].is_used = false;
        }
    }

    // Of the few cameras that contradict the others.
    void search_lateness() {
        std::vector<std::size_t> doubtful;
        for (std::size_t c = 0; c < solution_.cameras.size(); ++c) {
            const CameraFigures& figures = solution_.cameras[c];
            if (std::abs(figures.late_instants) > kDoubtfulLate ||
                figures.num_outliers > figures.num_used / kDoubtfulPart)
                doubtful.push_back(c);
        }
        if (3 * doubtful.size() > solution_.cameras.size()) return;
        for (const std::size_t c : doubtful) {
            report(fmt::format("looking whether camera '{}' is late", nominal_[c].name));
            solution_.cameras[c].late_instants =
                large_lateness(solution_, c, nominal_[c], options_.num_threads);
        }
    }

    // A solution from four fifths of the lights, measured with the rest.
    Expected<void> hold_out() {
        Bundle part = solution_.bundle;
        std::mt19937 choose(1);
        std::vector<std::size_t> held_out;
        for (std::size_t i = 0; i < part.sightings.size(); ++i) {
            if (!part.sightings[i].is_used || choose() % kHeldOutOf != 0) continue;
            part.sightings[i].is_used = false;
            held_out.push_back(i);
        }
        drop_lonely(part);
        if (const auto done = adjust_all(part, options_.lens); !done) return done;
        std::vector<double> sums(part.cameras.size(), 0.0), counts(part.cameras.size(), 0.0);
        for (const std::size_t i : held_out) {
            const Eigen::Vector2d error = error_px(part, part.sightings[i]);
            if (!error.allFinite()) continue;
            sums[part.sightings[i].camera] += error.squaredNorm();
            counts[part.sightings[i].camera] += 2.0;
        }
        for (std::size_t c = 0; c < sums.size(); ++c)
            solution_.cameras[c].held_out_px = std::sqrt(sums[c] / std::max(counts[c], 1.0));
        solution_.held_out_px =
            std::sqrt(std::accumulate(sums.begin(), sums.end(), 0.0) /
                      std::max(1.0, std::accumulate(counts.begin(), counts.end(), 0.0)));
        return {};
    }

    const WandOptions& options_;
    std::vector<BundleCamera> nominal_;
    WandSolution solution_;
    std::vector<InstantRange> ranges_;
    double sigma_ = 1.0;  // [px] of the noise of a coordinate
};

}  // namespace

Expected<WandSolution> solve_wand(const Wand& wand,
                                  const std::vector<NominalCamera>& nominal,
                                  const LightPoints& points,
                                  const WandOptions& options) {
    return Solver(wand, nominal, options).solve(points);
}

}  // namespace atrium::calibrate
