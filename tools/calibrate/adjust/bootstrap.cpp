#include "tools/calibrate/adjust/bootstrap.hpp"

#include "core/base/median.hpp"
#include "tools/calibrate/adjust/place_camera.hpp"
#include "tools/calibrate/adjust/place_wands.hpp"

#include <fmt/format.h>
#include <opencv2/calib3d.hpp>
#include <opencv2/core/eigen.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

namespace atrium::calibrate {
namespace {

constexpr std::size_t kPairsTried = 10;         // those with the most
constexpr std::size_t kPointsTried = 600;       // per pair
constexpr std::size_t kInstants = 250;          // that suffice to place the cameras
constexpr std::size_t kInstantsPerCamera = 60;  // at least, where a camera has them
constexpr int kManyIterations = 25;
constexpr int kFewIterations = 8;          // after a camera more
constexpr double kWide_rad = 0.35;         // a wider angle between two cameras gains nothing
constexpr double kLengthSpread = 0.03;     // of the wand, between instants, that a good pair has
constexpr double kFine = 0.004;            // after an adjustment
constexpr double kEssentialError = 0.004;  // of normalised coordinates

// Sightings of the same light at the same instant in two cameras.
struct Shared {
    std::size_t a = 0, b = 0;
    std::vector<std::pair<std::uint32_t, std::uint32_t>> sightings;  // indices
};

struct PairPlace {
    std::size_t shared = 0;  // index of the pair
    double focal_scale = 1.0;
    geometry::RigidTransform b_from_a;
    double quality = 0.0;
};

class Bootstrap {
public:
    Bootstrap(Bundle& bundle, const BootstrapOptions& options)
        : bundle_(bundle), options_(options), ranges_(ranges_of(bundle)) {}

    Expected<void> run() {
        if (const auto done = start(); !done) return done;
        while (const auto camera = next_camera()) {
            if (!place(*camera)) {
                failed_.push_back(*camera);
                continue;
            }
            if (const auto done = refine(LensFreedom::kRadial, 1, kFewIterations); !done)
                return done;
            failed_.clear();  // may succeed with more known lights
        }
        if (const auto done = check_all_placed(); !done) return done;
        return finish();
    }

private:
    double width() const { return bundle_.cameras.front().width; }
    void report(const std::string& text) const {
        if (options_.report) options_.report(text);
    }

    std::vector<Shared> find_shared() const {
        const std::size_t n = bundle_.cameras.size();
        std::vector<Shared> pairs(n * n);
        for (const InstantRange& range : ranges_) {
            for (std::size_t i = range.begin; i < range.end; ++i) {
                for (std::size_t j = i + 1; j < range.end; ++j) {
                    const Sighting& first = bundle_.sightings[i];
                    const Sighting& second = bundle_.sightings[j];
                    if (first.light != second.light || first.camera == second.camera) continue;
                    Shared& pair = pairs[first.camera * n + second.camera];
                    pair.a = first.camera;
                    pair.b = second.camera;
                    pair.sightings.emplace_back(static_cast<std::uint32_t>(i),
                                                static_cast<std::uint32_t>(j));
                }
            }
        }
        std::erase_if(pairs, [](const Shared& pair) { return pair.sightings.size() < kMinShared; });
        std::ranges::stable_sort(pairs, [](const Shared& left, const Shared& right) {
            return left.sightings.size() > right.sightings.size();
        });
        return pairs;
    }

    // Places the first two cameras and their wands.
    Expected<void> start() {
        report("placing the first two cameras");
        const std::vector<Shared> pairs = find_shared();
        if (pairs.empty())
            return make_error(
                ErrorKind::kInvalidData,
                fmt::format("no two cameras see at least {} lights at the same instants; sweep the "
                            "wand where the cameras look, and check that they are synchronised",
                            kMinShared));
        std::vector<PairPlace> places;
        for (std::size_t i = 0; i < std::min(pairs.size(), kPairsTried); ++i) {
            for (const double scale : kFocalScales) {
                if (scale != 1.0 && bundle_.wand.size() == 1) continue;  // nothing would tell
                if (auto place = place_pair(pairs[i], scale)) {
                    place->shared = i;
                    places.push_back(*place);
                }
            }
        }
        if (places.empty())
            return make_error(ErrorKind::kInvalidData,
                              "no two cameras agree on where the wand is; are the cameras "
                              "synchronised, and is the wand's file that of this wand?");
        const PairPlace best = *std::ranges::max_element(places, {}, &PairPlace::quality);
        BundleCamera& a = bundle_.cameras[pairs[best.shared].a];
        BundleCamera& b = bundle_.cameras[pairs[best.shared].b];
        for (BundleCamera& camera : bundle_.cameras) camera.lens[0] *= best.focal_scale;
        a.set_camera_from_world({});
        b.set_camera_from_world(best.b_from_a);
        a.is_placed = b.is_placed = true;
        choose_instants();
        place_wands(bundle_, ranges_, chosen_, kCoarse * width());
        if (const auto done = refine(LensFreedom::kFocal, 1, kManyIterations); !done) return done;
        return refine(LensFreedom::kRadial, 2, kManyIterations);
    }

    // The essential matrix of a pair, and its scale from the lengths of the wand.
    std::optional<PairPlace> place_pair(const Shared& pair, double focal_scale) const {
        std::vector<cv::Point2d> in_a, in_b;
        const std::size_t step = pair.sightings.size() / kPointsTried + 1;
        std::vector<std::size_t> used;
        std::size_t num_instants = 0;
        std::uint32_t last = UINT32_MAX;
        for (std::size_t i = 0; i < pair.sightings.size(); ++i) {
            const auto [first, second] = pair.sightings[i];
            const std::uint32_t instant_of_both = bundle_.sightings[first].instant;
            num_instants += instant_of_both != last ? 1 : 0;
            last = instant_of_both;
            if (num_instants % step != 0) continue;  // whole instants: lengths need two lights
            in_a.push_back(normalised(bundle_.sightings[first], focal_scale));
            in_b.push_back(normalised(bundle_.sightings[second], focal_scale));
            used.push_back(i);
        }
        const cv::Mat unit = cv::Mat::eye(3, 3, CV_64F);
        cv::Mat inliers, rotation, translation, points;
        const cv::Mat essential =
            cv::findEssentialMat(in_a, in_b, unit, cv::RANSAC, 0.999, kEssentialError, inliers);
        if (essential.rows != 3) return std::nullopt;
        const int num = cv::recoverPose(
            essential, in_a, in_b, unit, rotation, translation, 1e3, inliers, points);
        if (num < static_cast<int>(kMinShared / 2)) return std::nullopt;
        PairPlace place;
        place.focal_scale = focal_scale;
        Eigen::Matrix3d r;
        Eigen::Vector3d t;
        cv::cv2eigen(rotation, r);
        cv::cv2eigen(translation, t);
        place.b_from_a = {Eigen::Quaterniond(r), t};

        std::vector<double> angles, scales;
        const Eigen::Vector3d centre_b = -(r.transpose() * t);
        std::vector<std::optional<Eigen::Vector3d>> lights(bundle_.wand.size());
        std::uint32_t instant = UINT32_MAX;
        const auto end_instant = [&] {
            add_scales(lights, scales);
            std::ranges::fill(lights, std::nullopt);
        };
        for (std::size_t i = 0; i < used.size(); ++i) {
            if (inliers.at<std::uint8_t>(static_cast<int>(i)) == 0) continue;
            const Sighting& seen = bundle_.sightings[pair.sightings[used[i]].first];
            if (seen.instant != instant) end_instant();
            instant = seen.instant;
            Eigen::Vector4d h;
            for (int k = 0; k < 4; ++k) h[k] = points.at<double>(k, static_cast<int>(i));
            const Eigen::Vector3d point = h.hnormalized();
            lights[seen.light] = point;
            angles.push_back(std::acos(
                std::clamp(point.normalized().dot((point - centre_b).normalized()), -1.0, 1.0)));
        }
        end_instant();
        double spread = 0.0;
        if (bundle_.wand.size() > 1) {
            if (scales.size() < kMinShared / 4) return std::nullopt;
            const double middle = median_of(scales);
            for (double& scale : scales) scale = std::abs(std::log(scale / middle));
            spread = median_of(scales);
            place.b_from_a.translation *= middle;
        }
        const double off = spread / kLengthSpread;
        place.quality = num * static_cast<double>(step) *
                        std::min(1.0, median_of(angles) / kWide_rad) / (1.0 + off * off);
        return place;
    }

    // Known by measured length of each pair of lights.
    void add_scales(const std::vector<std::optional<Eigen::Vector3d>>& lights,
                    std::vector<double>& scales) const {
        for (std::size_t i = 0; i < lights.size(); ++i) {
            for (std::size_t j = i + 1; j < lights.size(); ++j) {
                if (!lights[i] || !lights[j]) continue;
                const double known = (bundle_.wand.lights_m[i] - bundle_.wand.lights_m[j]).norm();
                const double measured = (*lights[i] - *lights[j]).norm();
                if (measured > 0.0) scales.push_back(known / measured);
            }
        }
    }

    cv::Point2d normalised(const Sighting& seen, double focal_scale) const {
        geometry::PinholeCamera lens = bundle_.cameras[seen.camera].intrinsics();
        lens.fx *= focal_scale;
        lens.fy *= focal_scale;
        const Eigen::Vector3d ray = lens.ray_camera(lens.undistort(seen.px).value_or(seen.px));
        return {ray.x(), ray.y()};
    }

    // Spread over time; of each camera enough, where it has them.
    void choose_instants() {
        std::vector<std::uint32_t> seen_by_two;
        std::vector<std::vector<std::uint32_t>> of_camera(bundle_.cameras.size());
        for (std::uint32_t i = 0; i < ranges_.size(); ++i) {
            std::vector<std::uint32_t> cameras;
            for (std::size_t s = ranges_[i].begin; s < ranges_[i].end; ++s) {
                const std::uint32_t camera = bundle_.sightings[s].camera;
                if (cameras.empty() || cameras.back() != camera) cameras.push_back(camera);
            }
            if (cameras.size() < 2) continue;
            seen_by_two.push_back(i);
            for (const std::uint32_t camera : cameras) of_camera[camera].push_back(i);
        }
        const auto take = [&](const std::vector<std::uint32_t>& from, std::size_t count) {
            const std::size_t step = std::max<std::size_t>(1, from.size() / count);
            for (std::size_t i = 0; i < from.size(); i += step) chosen_.push_back(from[i]);
        };
        take(seen_by_two, kInstants);
        for (const auto& instants : of_camera) take(instants, kInstantsPerCamera);
        std::ranges::sort(chosen_);
        chosen_.erase(std::unique(chosen_.begin(), chosen_.end()), chosen_.end());
    }

    Expected<void> refine(LensFreedom lens, int rounds, int iterations) {
        for (int round = 0; round < rounds; ++round) {
            AdjustOptions adjustment;
            adjustment.lens = lens;
            adjustment.robust_px = std::max(1.0, kFine * width());
            adjustment.max_iterations = iterations;
            adjustment.num_threads = options_.num_threads;
            if (const auto done = adjust(bundle_, adjustment); !done) return done;
            place_wands(bundle_, ranges_, chosen_, 2.0 * kFine * width());
        }
        return {};
    }

    std::size_t num_known(std::size_t camera) const {
        std::size_t count = 0;
        for (const std::uint32_t instant : chosen_) {
            if (!bundle_.wands[instant].is_placed) continue;
            for (std::size_t s = ranges_[instant].begin; s < ranges_[instant].end; ++s)
                count += bundle_.sightings[s].camera == camera ? 1 : 0;
        }
        return count;
    }

    std::optional<std::size_t> next_camera() const {
        std::optional<std::size_t> best;
        std::size_t most = kMinShared / 2 - 1;
        for (std::size_t i = 0; i < bundle_.cameras.size(); ++i) {
            if (bundle_.cameras[i].is_placed || std::ranges::count(failed_, i) > 0) continue;
            const std::size_t count = num_known(i);
            if (count <= most) continue;
            most = count;
            best = i;
        }
        return best;
    }

    bool place(std::size_t camera) {
        report(fmt::format("placing camera '{}'", bundle_.cameras[camera].name));
        if (!place_camera(bundle_, camera, ranges_, chosen_)) return false;
        place_wands(bundle_, ranges_, chosen_, kCoarse * width());
        return true;
    }

    Expected<void> check_all_placed() const {
        std::string names;
        bool sees_too_little = true;
        for (std::size_t i = 0; i < bundle_.cameras.size(); ++i) {
            if (bundle_.cameras[i].is_placed) continue;
            names += fmt::format("{}'{}'", names.empty() ? "" : ", ", bundle_.cameras[i].name);
            sees_too_little = sees_too_little && num_known(i) < kMinShared / 2;
        }
        if (names.empty()) return {};
        return make_error(
            ErrorKind::kInvalidData,
            fmt::format(
                "no place found for {}: {}",
                names,
                sees_too_little
                    ? "the wand was not seen there and in two other cameras at once often enough; "
                      "sweep it through the space that they share"
                    : "what they see fits no place in the room; are they synchronised with the "
                      "others, and do the files belong to these cameras?"));
    }

    // All instants, with all that is known.
    Expected<void> finish() {
        chosen_.resize(ranges_.size());
        std::iota(chosen_.begin(), chosen_.end(), 0U);
        place_wands(bundle_, ranges_, chosen_, 2.0 * kFine * width());
        return {};
    }

    Bundle& bundle_;
    const BootstrapOptions& options_;
    std::vector<InstantRange> ranges_;
    std::vector<std::uint32_t> chosen_;
    std::vector<std::size_t> failed_;
};

}  // namespace

Expected<void> bootstrap(Bundle& bundle, const BootstrapOptions& options) {
    return Bootstrap(bundle, options).run();
}

}  // namespace atrium::calibrate
