#include "tools/calibrate/wand/find_lights.hpp"

#include "tools/calibrate/wand/label_lights.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <set>
#include <span>
#include <tuple>

namespace atrium::calibrate {
namespace {

constexpr std::size_t kFewFull = 50;  // pictures; fewer prove nothing about the wand's file
constexpr double kLabelled = 0.15;    // share of them that shows the wand, at least

using Key = std::tuple<std::uint32_t, std::uint32_t, std::uint32_t>;

Key key_of(const Sighting& s) { return {s.instant, s.camera, s.light}; }

std::set<Key> keys_of(const std::vector<Sighting>& sightings) {
    std::set<Key> keys;
    for (const Sighting& sighting : sightings) keys.insert(key_of(sighting));
    return keys;
}

std::size_t index_of(const std::vector<BundleCamera>& cameras, const std::string& name) {
    return static_cast<std::size_t>(std::ranges::find(cameras, name, &BundleCamera::name) -
                                    cameras.begin());
}

// The points of one instant in one camera, as sightings of lights.
Expected<void> add_sightings(const Wand& wand,
                             const std::optional<LightLabeller>& labeller,
                             std::span<const LightPoint> points,
                             const Sighting& like,
                             const std::string& camera,
                             std::vector<Sighting>& sightings) {
    const bool has_labels =
        std::ranges::any_of(points, [](const LightPoint& p) { return p.light.has_value(); });
    Sighting sighting = like;
    if (has_labels) {
        std::vector<std::uint8_t> is_seen(wand.size(), 0);
        for (const LightPoint& point : points) {
            if (!point.light) continue;
            if (*point.light >= wand.size())
                return make_error(ErrorKind::kInvalidData,
                                  fmt::format("camera '{}', instant {}: light {}; the wand has "
                                              "lights 0 to {} (--wand FILE)",
                                              camera,
                                              point.instant,
                                              *point.light,
                                              wand.size() - 1));
            if (is_seen[*point.light]++ != 0)
                return make_error(ErrorKind::kInvalidData,
                                  fmt::format("camera '{}', instant {}: light {} twice",
                                              camera,
                                              point.instant,
                                              *point.light));
            sighting.light = *point.light;
            sighting.px = point.px;
            sightings.push_back(sighting);
        }
        return {};
    }
    if (!labeller)
        return make_error(ErrorKind::kConfiguration,
                          "the lights of this wand look alike: it needs one light, three or more "
                          "on a line with distances that differ from both ends, or a flat shape "
                          "that looks different turned; or a 'light' for each point");
    std::vector<Eigen::Vector2d> px;
    for (const LightPoint& point : points) px.push_back(point.px);
    if (const auto labels = labeller->label(px)) {
        for (std::uint32_t light = 0; light < labels->size(); ++light) {
            sighting.light = light;
            sighting.px = px[(*labels)[light]];
            sightings.push_back(sighting);
        }
    }
    return {};
}

// Pictures with enough points, of which hardly any shows this wand.
Expected<void> check_labels(const LightPoints& points, const WandSolution& solution) {
    std::size_t num_full = 0, num_labelled = 0;
    for (const LightCamera& camera : points) {
        std::map<std::uint32_t, std::size_t> num_points;
        for (const LightPoint& point : camera.points) ++num_points[point.instant];
        for (const auto& [instant, num] : num_points)
            num_full += num >= solution.bundle.wand.size() ? 1 : 0;
    }
    for (const CameraFigures& figures : solution.cameras) num_labelled += figures.num_instants;
    if (num_full < kFewFull || static_cast<double>(num_labelled) >= kLabelled * num_full) return {};
    return make_error(
        ErrorKind::kInvalidData,
        fmt::format("of {} pictures with {} points or more, {} show lights at the distances "
                    "that the wand has: is --wand the file of this wand, in metres? Else cover "
                    "lamps and reflections",
                    num_full,
                    solution.bundle.wand.size(),
                    num_labelled));
}

void add_at_places(const Bundle& bundle,
                   std::span<const LightPoint> points,
                   double most_px,
                   Sighting sighting,
                   std::vector<Sighting>& found) {
    for (sighting.light = 0; sighting.light < bundle.wand.size(); ++sighting.light) {
        const Eigen::Vector2d wanted =
            project(bundle.cameras[sighting.camera], light_world(bundle, sighting));
        const LightPoint* nearest = nullptr;
        for (const LightPoint& point : points) {
            if (point.light && *point.light != sighting.light) continue;
            if (nearest == nullptr || (point.px - wanted).norm() < (nearest->px - wanted).norm())
                nearest = &point;
        }
        if (nearest == nullptr || !((nearest->px - wanted).norm() <= most_px)) continue;
        sighting.px = nearest->px;
        found.push_back(sighting);
    }
}

}  // namespace

Expected<void> find_lights(const LightPoints& points, WandSolution& solution) {
    Bundle& bundle = solution.bundle;
    const auto labeller = LightLabeller::make(bundle.wand);
    std::map<std::uint32_t, std::uint32_t> index_of_instant;
    for (const LightCamera& camera : points)
        for (const LightPoint& point : camera.points) index_of_instant[point.instant] = 0;
    for (auto& [instant, index] : index_of_instant) {
        index = static_cast<std::uint32_t>(solution.instants.size());
        solution.instants.push_back(instant);
    }
    bundle.wands.resize(solution.instants.size());
    for (const LightCamera& camera : points) {
        const std::size_t c = index_of(bundle.cameras, camera.name);
        if (c == bundle.cameras.size()) continue;
        CameraFigures& figures = solution.cameras[c];
        figures.num_points = camera.points.size();
        for (std::size_t begin = 0; begin < camera.points.size();) {
            std::size_t end = begin;
            const std::uint32_t instant = camera.points[begin].instant;
            while (end < camera.points.size() && camera.points[end].instant == instant) ++end;
            Sighting like;
            like.camera = static_cast<std::uint32_t>(c);
            like.instant = index_of_instant[instant];
            const std::size_t before = bundle.sightings.size();
            const auto done = add_sightings(bundle.wand,
                                            labeller,
                                            std::span(camera.points).subspan(begin, end - begin),
                                            like,
                                            camera.name,
                                            bundle.sightings);
            if (!done) return done;
            figures.num_instants += bundle.sightings.size() > before ? 1 : 0;
            begin = end;
        }
    }
    std::ranges::stable_sort(bundle.sightings, {}, key_of);
    return check_labels(points, solution);
}

void find_lights_at_places(const LightPoints& points, double most_px, WandSolution& solution) {
    Bundle& bundle = solution.bundle;
    std::vector<Sighting> found;
    for (const LightCamera& camera : points) {
        const std::size_t c = index_of(bundle.cameras, camera.name);
        if (c == bundle.cameras.size()) continue;
        std::size_t next = 0;
        for (std::uint32_t i = 0; i < bundle.wands.size(); ++i) {
            while (next < camera.points.size() &&
                   camera.points[next].instant < solution.instants[i])
                ++next;
            std::size_t end = next;
            while (end < camera.points.size() && camera.points[end].instant == solution.instants[i])
                ++end;
            Sighting like;
            like.camera = static_cast<std::uint32_t>(c);
            like.instant = i;
            if (bundle.wands[i].is_placed)
                add_at_places(bundle,
                              std::span(camera.points).subspan(next, end - next),
                              most_px,
                              like,
                              found);
            next = end;
        }
    }
    // what was labelled and lies elsewhere contradicts the solution, and counts
    const std::set<Key> known = keys_of(found);
    for (const Sighting& labelled : bundle.sightings)
        if (!known.contains(key_of(labelled))) found.push_back(labelled);
    std::ranges::stable_sort(found, {}, key_of);
    bundle.sightings = std::move(found);
}

}  // namespace atrium::calibrate
