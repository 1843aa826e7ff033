#include "core/base/median.hpp"
#include "tools/calibrate/adjust/place_wands.hpp"
#include "tools/calibrate/floor/find_marks.hpp"
#include "tools/calibrate/floor/rig_bundle.hpp"
#include "tools/calibrate/wand/find_lights.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

namespace atrium::calibrate {
namespace {

constexpr double kStill_m = 0.01;   // of a light at rest, between instants
constexpr double kOffRig_px = 5.0;  // median error of a light that is one place
constexpr double kWandOff = 0.01, kWandOffLeast_m = 0.003;

Eigen::Vector3d median_place(const std::vector<Eigen::Vector3d>& places) {
    Eigen::Vector3d middle;
    for (Eigen::Index k = 0; k < 3; ++k) {
        std::vector<double> values;
        for (const Eigen::Vector3d& place : places) values.push_back(place[k]);
        middle[k] = median_of(std::move(values));
    }
    return middle;
}

class LyingLights {
public:
    LyingLights(const config::Rig& rig, const std::optional<Wand>& wand) : rig_(rig), wand_(wand) {}

    Expected<FoundMarks> find(const LightPoints& points) {
        if (const auto done = take(points); !done) return tl::unexpected(done.error());
        if (const auto done = locate(); !done) return tl::unexpected(done.error());
        if (wand_ && wand_->form() == WandForm::kLine) return of_line();
        return of_lights();
    }

private:
    // Sightings of lights with numbers, by instant and light.
    Expected<void> take(const LightPoints& points) {
        bundle_.cameras = ideal_cameras(rig_);
        std::vector<std::size_t> index_of;
        for (const LightCamera& camera : points) {
            const auto index = camera_index(rig_, camera.name);
            if (!index) return tl::unexpected(index.error());
            index_of.push_back(*index);
            for (const LightPoint& point : camera.points) {
                if (wand_) continue;
                if (!point.light)
                    return make_error(
                        ErrorKind::kConfiguration,
                        fmt::format(
                            "camera '{}', instant {}: a point without a number of its light; "
                            "number the lights (column light: 0 is the origin, 1 on +X, 2 "
                            "on the side of +Y), or give --wand",
                            camera.name,
                            point.instant));
                add(*index, point.instant, *point.light, point.px);
            }
        }
        if (wand_) {
            WandSolution solution;
            solution.bundle.wand = *wand_;
            for (std::size_t i = 0; i < points.size(); ++i)
                solution.bundle.cameras.push_back(bundle_.cameras[index_of[i]]);
            solution.cameras.resize(points.size());
            if (const auto done = find_lights(points, solution); !done) return done;
            for (const Sighting& sighting : solution.bundle.sightings)
                add(index_of[sighting.camera],
                    solution.instants[sighting.instant],
                    sighting.light,
                    sighting.px);
        }
        return {};
    }

    void add(std::size_t camera, std::uint32_t instant, std::uint32_t light, Eigen::Vector2d px) {
        const auto linear = undistorted(rig_.cameras[camera].intrinsics, px);
        if (linear)
            seen_[{instant, light}].push_back(
                {static_cast<std::uint32_t>(camera), 0, light, *linear, true});
    }

    Expected<void> locate() {
        std::vector<double> errors;
        for (const auto& [key, sightings] : seen_) {
            std::vector<const Sighting*> views;
            for (const Sighting& sighting : sightings) views.push_back(&sighting);
            const auto at = triangulate(bundle_, views);
            if (!at) continue;
            places_[key.second].emplace_back(key.first, *at);
            for (const Sighting& sighting : sightings)
                errors.push_back(
                    (project(bundle_.cameras[sighting.camera], *at) - sighting.px).norm());
        }
        if (places_.empty())
            return make_error(
                ErrorKind::kInvalidData,
                "no light is seen by two cameras from different sides: put them where "
                "two or more cameras look");
        error_px_ = median_of(std::move(errors));
        if (error_px_ > kOffRig_px)
            return make_error(
                ErrorKind::kInvalidData,
                fmt::format(
                    "the rig does not fit these points: its cameras see one light {:.0f} px "
                    "apart. Did a camera move since the calibration, and have all the same "
                    "numbers of lights?",
                    error_px_));
        return {};
    }

    // Lights at rest.
    Expected<FoundMarks> of_lights() {
        std::map<std::uint32_t, Eigen::Vector3d> still;
        for (const auto& [light, places] : places_) {
            std::vector<Eigen::Vector3d> at;
            for (const auto& [instant, place] : places) at.push_back(place);
            const Eigen::Vector3d middle = median_place(at);
            std::vector<double> off;
            for (const Eigen::Vector3d& place : at) off.push_back((place - middle).norm());
            if (median_of(std::move(off)) > kStill_m)
                return make_error(
                    ErrorKind::kInvalidData,
                    fmt::format("light {} moves: give points of lights that lie still "
                                "on the floor",
                                light));
            still[light] = middle;
        }
        FoundMarks found;
        for (std::uint32_t light = 0; light < 3; ++light)
            if (!still.contains(light))
                return make_error(
                    ErrorKind::kInvalidData,
                    fmt::format("light {} is not seen by two cameras: a floor needs lights 0 (the "
                                "origin), 1 (on +X) and 2 (on the side of +Y)",
                                light));
        found.marks.origin = still[0];
        found.marks.on_x = still[1];
        found.marks.on_y_side = still[2];
        for (const auto& [light, place] : still) found.marks.on_floor.push_back(place);
        if (wand_)
            for (const auto& [a, at_a] : still)
                for (const auto& [b, at_b] : still)
                    if (a < b) check_length(found, a, b, (at_a - at_b).norm());
        tell(found, still.size());
        return found;
    }

    // A wand on a line, at several places.
    Expected<FoundMarks> of_line() {
        FoundMarks found;
        FloorMarks& marks = found.marks;
        marks.has_y_side = false;
        bool is_first = true;
        const std::uint32_t last = static_cast<std::uint32_t>(wand_->size() - 1);
        std::map<std::uint32_t, std::map<std::uint32_t, Eigen::Vector3d>> by_instant;
        for (const auto& [light, places] : places_)
            for (const auto& [instant, place] : places) by_instant[instant][light] = place;
        std::vector<double> lengths;
        for (const auto& [instant, lights] : by_instant) {
            for (const auto& [light, place] : lights) marks.on_floor.push_back(place);
            if (!lights.contains(0) || !lights.contains(last)) continue;
            lengths.push_back((lights.at(0) - lights.at(last)).norm());
            if (!is_first) continue;
            is_first = false;
            marks.origin = lights.at(0);
            marks.on_x = lights.at(last);
        }
        if (is_first)
            return make_error(ErrorKind::kInvalidData,
                              "no instant shows both ends of the wand to two cameras");
        check_length(found, 0, last, median_of(std::move(lengths)));
        tell(found, marks.on_floor.size());
        return found;
    }

    void check_length(FoundMarks& found, std::uint32_t a, std::uint32_t b, double seen_m) const {
        if (a >= wand_->size() || b >= wand_->size()) return;
        const double known_m = (wand_->lights_m[a] - wand_->lights_m[b]).norm();
        if (std::abs(seen_m - known_m) <= std::max(kWandOffLeast_m, kWandOff * known_m)) return;
        found.problems.push_back(
            fmt::format("lights {} and {} are seen {:.0f} mm apart, and --wand says {:.0f} mm: the "
                        "rig has another scale, or this is another wand",
                        a,
                        b,
                        1000.0 * seen_m,
                        1000.0 * known_m));
    }

    void tell(FoundMarks& found, std::size_t num) const {
        found.told.push_back(fmt::format(
            "marks: {} places on the floor, {:.2f} px off where the rig says", num, error_px_));
    }

    const config::Rig& rig_;
    const std::optional<Wand>& wand_;
    Bundle bundle_;
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::vector<Sighting>> seen_;
    // per light, with the instant
    std::map<std::uint32_t, std::vector<std::pair<std::uint32_t, Eigen::Vector3d>>> places_;
    double error_px_ = 0.0;
};

}  // namespace

Expected<FoundMarks> marks_of_lights(const config::Rig& rig,
                                     const LightPoints& points,
                                     const std::optional<Wand>& wand) {
    return LyingLights(rig, wand).find(points);
}

}  // namespace atrium::calibrate
