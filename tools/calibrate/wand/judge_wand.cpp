#include "tools/calibrate/wand/judge_wand.hpp"

#include "core/base/median.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <tuple>

namespace atrium::calibrate {
namespace {

constexpr double kUsable_px = 1.0;
constexpr std::size_t kFewInstants = 100;   // of a sweep
constexpr std::size_t kFewPerCamera = 200;  // sightings that a lens needs
constexpr std::size_t kTooFewPerCamera = 60;
constexpr double kManyOutliers = 0.25;
constexpr double kSmallCoverage = 0.3;
constexpr double kLate = 0.25;  // instants
constexpr double kOffLight_m = 0.0015;
constexpr double kSamePictures = 0.8;

double share_of_outliers(const CameraFigures& figures) {
    const auto all = static_cast<double>(figures.num_used + figures.num_outliers);
    return all > 0.0 ? static_cast<double>(figures.num_outliers) / all : 0.0;
}

class Judge {
public:
    Judge(const WandSolution& solution, double rate_hz) : solution_(solution), rate_hz_(rate_hz) {}

    Verdict run() {
        judge_whole();
        judge_wand_file();
        for (std::size_t c = 0; c < solution_.cameras.size(); ++c) judge_camera(c);
        tell_whole();
        return std::move(verdict_);
    }

private:
    const std::string& name(std::size_t c) const { return solution_.bundle.cameras[c].name; }

    void tell_whole() {
        const double px = solution_.held_out_px;
        const double length_mm = 1000.0 * solution_.bundle.wand.length_m();
        std::vector<std::string>& told = verdict_.told;
        told.insert(told.begin(),
                    fmt::format("{}: {:.2f} px RMS of lights that the solution did not use, {:.2f} "
                                "px of the others; "
                                "{} cameras, {} instants",
                                !verdict_.problems.empty() ? "wrong"
                                : px <= kGood_px           ? "good"
                                                           : "usable",
                                px,
                                solution_.rms_px,
                                solution_.cameras.size(),
                                solution_.num_instants));
        if (length_mm > 0.0)
            told.insert(
                told.begin() + 1,
                fmt::format("wand: its {:.0f} mm, seen by single lights, are off by {:.2f} mm RMS",
                            length_mm,
                            1000.0 * solution_.wand_length_rms_m));
    }

    void judge_whole() {
        const double px = solution_.held_out_px;
        if (px > kUsable_px)
            verdict_.problems.push_back(fmt::format(
                "errors of {:.2f} px are no calibration; the cameras named below are the first to "
                "look at",
                px));
        if (solution_.num_instants < kFewInstants)
            verdict_.checks.push_back(
                fmt::format("only {} instants show the wand in two cameras or more; 300 are better",
                            solution_.num_instants));
    }

    void judge_camera(std::size_t c) {
        const CameraFigures& figures = solution_.cameras[c];
        verdict_.told.push_back(
            fmt::format("camera '{}': {:.2f} px, {:.2f} mm in the middle of the sweep; {} lights, "
                        "{} outliers; lights in {:.0f} % of the picture; f {:.1f} px",
                        name(c),
                        figures.held_out_px,
                        figures.middle_mm,
                        figures.num_used,
                        figures.num_outliers,
                        100.0 * figures.coverage,
                        solution_.bundle.cameras[c].lens[0]));
        const double late = figures.late_instants;
        if (std::abs(late) >= kLate) {
            verdict_.problems.push_back(fmt::format(
                "camera '{}' is {} by {:.1f} instants ({:.0f} ms): its pictures fit the motion of "
                "the wand at another time; check its trigger, or shift its pictures by {}",
                name(c),
                late > 0.0 ? "late" : "early",
                std::abs(late),
                1000.0 * std::abs(late) / rate_hz_,
                std::abs(late) < 0.75 ? "less than an instant, by its clock"
                                      : fmt::format("{:.0f}", std::round(-late))));
        } else if (share_of_outliers(figures) > kManyOutliers && !is_wand_to_blame(figures)) {
            verdict_.problems.push_back(fmt::format(
                "camera '{}' contradicts the others in {:.0f} % of its lights: it was moved during "
                "the sweep, or its pictures are those of another camera or sweep",
                name(c),
                100.0 * share_of_outliers(figures)));
        } else if (figures.num_used < kTooFewPerCamera) {
            verdict_.problems.push_back(fmt::format(
                "camera '{}' shows only {} lights together with other cameras; sweep the wand "
                "where it looks until it has {}",
                name(c),
                figures.num_used,
                kFewPerCamera));
        } else if (figures.num_used < kFewPerCamera) {
            verdict_.checks.push_back(
                fmt::format("camera '{}' shows only {} lights together with other cameras; {} are "
                            "better",
                            name(c),
                            figures.num_used,
                            kFewPerCamera));
        } else if (figures.coverage < kSmallCoverage) {
            verdict_.checks.push_back(fmt::format(
                "camera '{}' saw lights in {:.0f} % of its picture only; outside of these its lens "
                "is a guess: sweep there, too",
                name(c),
                100.0 * figures.coverage));
        }
    }

    // A light at another place than the file says is an outlier of every camera alike.
    bool is_wand_to_blame(const CameraFigures& figures) const {
        if (!has_wrong_light_) return false;
        std::vector<double> shares;
        for (const CameraFigures& each : solution_.cameras)
            shares.push_back(share_of_outliers(each));
        return share_of_outliers(figures) < 1.5 * median_of(std::move(shares));
    }

    void judge_wand_file() {
        const auto& offsets = solution_.light_offsets_m;
        for (std::size_t light = 0; light < offsets.size(); ++light) {
            if (std::abs(offsets[light]) < kOffLight_m) continue;
            has_wrong_light_ = true;
            verdict_.problems.push_back(
                fmt::format("light {} of the wand is seen {:.1f} mm further {} than --wand says: "
                            "measure the distances of its lights again",
                            light,
                            1000.0 * std::abs(offsets[light]),
                            offsets[light] > 0.0 ? "along it" : "back"));
        }
    }

    const WandSolution& solution_;
    double rate_hz_;
    bool has_wrong_light_ = false;
    Verdict verdict_;
};

using Place = std::tuple<std::uint32_t, double, double>;

std::set<Place> places_of(const LightCamera& camera) {
    std::set<Place> places;
    for (const LightPoint& point : camera.points)
        places.insert({point.instant, point.px.x(), point.px.y()});
    return places;
}

}  // namespace

Verdict judge_wand(const WandSolution& solution, double rate_hz) {
    return Judge(solution, rate_hz).run();
}

std::string same_pictures(const LightPoints& points) {
    for (std::size_t a = 0; a < points.size(); ++a) {
        const std::set<Place> of_a = places_of(points[a]);
        for (std::size_t b = a + 1; b < points.size(); ++b) {
            const auto num_same = std::ranges::count_if(points[b].points, [&](const auto& point) {
                return of_a.contains({point.instant, point.px.x(), point.px.y()});
            });
            const auto fewer = static_cast<double>(
                std::max<std::size_t>(1, std::min(of_a.size(), points[b].points.size())));
            if (static_cast<double>(num_same) < kSamePictures * fewer) continue;
            return fmt::format(
                "cameras '{}' and '{}' have the same pictures: give each camera "
                "files, or a serial number, of its own",
                points[a].name,
                points[b].name);
        }
    }
    return {};
}

}  // namespace atrium::calibrate
