#include "tools/calibrate/adjust/place_wands.hpp"

#include "core/geometry/alignment.hpp"
#include "tools/calibrate/adjust/rays.hpp"

#include <algorithm>
#include <cmath>

namespace atrium::calibrate {
namespace {

constexpr double kEnough = 0.9;  // share of the sightings that ends the search for a better pair

// Sightings of one instant of two cameras, as places of the lights.
std::optional<geometry::RigidTransform> wand_of_pair(const Bundle& bundle,
                                                     std::span<const Sighting> sightings,
                                                     std::uint32_t a,
                                                     std::uint32_t b) {
    std::vector<std::optional<Eigen::Vector3d>> lights(bundle.wand.size());
    for (const Sighting& first : sightings) {
        if (first.camera != a) continue;
        for (const Sighting& second : sightings) {
            if (second.camera != b || second.light != first.light) continue;
            const Sighting* const both[] = {&first, &second};
            lights[first.light] = triangulate(bundle, both);
        }
    }
    return fit_wand(bundle.wand, lights);
}

}  // namespace

std::vector<InstantRange> ranges_of(const Bundle& bundle) {
    std::vector<InstantRange> ranges(bundle.wands.size());
    for (std::size_t i = 0; i < bundle.sightings.size(); ++i) {
        InstantRange& range = ranges[bundle.sightings[i].instant];
        if (range.begin == range.end) range.begin = i;
        range.end = i + 1;
    }
    return ranges;
}

std::optional<Eigen::Vector3d> triangulate(const Bundle& bundle,
                                           std::span<const Sighting* const> sightings) {
    std::vector<SeenRay> rays;
    for (const Sighting* sighting : sightings) {
        const BundleCamera& camera = bundle.cameras[sighting->camera];
        const auto ray =
            seen_ray(camera.intrinsics(), camera.camera_from_world().inverse(), sighting->px);
        if (ray) rays.push_back(*ray);
    }
    return nearest_to_rays(rays);
}

std::optional<geometry::RigidTransform> fit_wand(
    const Wand& wand, std::span<const std::optional<Eigen::Vector3d>> lights_world) {
    std::vector<Eigen::Vector3d> from, to;
    for (std::size_t i = 0; i < wand.size(); ++i) {
        if (!lights_world[i]) continue;
        from.push_back(wand.lights_m[i]);
        to.push_back(*lights_world[i]);
    }
    const WandForm form = wand.form();
    const std::size_t least = form == WandForm::kPoint ? 1 : form == WandForm::kLine ? 2 : 3;
    if (from.size() < least) return std::nullopt;
    const auto n = static_cast<double>(from.size());
    Eigen::Vector3d from_middle = Eigen::Vector3d::Zero(), to_middle = Eigen::Vector3d::Zero();
    for (std::size_t i = 0; i < from.size(); ++i) {
        from_middle += from[i] / n;
        to_middle += to[i] / n;
    }
    Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
    for (std::size_t i = 0; i < from.size(); ++i)
        spread += (to[i] - to_middle) * (from[i] - from_middle).transpose();
    geometry::RigidTransform pose;
    if (form == WandForm::kLine) {
        const Eigen::Vector3d along = from.back() - from.front();
        pose.rotation = geometry::rotation_between(along, spread * along);
    } else if (form == WandForm::kBody) {
        pose.rotation = Eigen::Quaterniond(geometry::rotation_of(spread));
    }
    pose.translation = to_middle - pose.rotation * from_middle;
    return pose;
}

void place_wands(Bundle& bundle,
                 std::span<const InstantRange> ranges,
                 std::span<const std::uint32_t> instants,
                 double most_px) {
    for (const std::uint32_t instant : instants) {
        const std::span<Sighting> sightings(bundle.sightings.data() + ranges[instant].begin,
                                            ranges[instant].end - ranges[instant].begin);
        std::vector<std::uint32_t> cameras;
        for (const Sighting& sighting : sightings) {
            if (!bundle.cameras[sighting.camera].is_placed) continue;
            if (cameras.empty() || cameras.back() != sighting.camera)
                cameras.push_back(sighting.camera);
        }
        WandPose& wand = bundle.wands[instant];
        const auto fits = [&](const Sighting& sighting) {
            return error_px(bundle, sighting).norm() <= most_px;  // false for NaN
        };
        geometry::RigidTransform best;
        std::ptrdiff_t most = 0;
        std::ptrdiff_t num_placed = 0;
        for (const Sighting& sighting : sightings)
            num_placed += bundle.cameras[sighting.camera].is_placed ? 1 : 0;
        // pairs of neighbours in the list last: those may stand side by side
        for (std::size_t apart = cameras.size() - 1; apart > 0 && apart < cameras.size(); --apart) {
            for (std::size_t i = 0; i + apart < cameras.size(); ++i) {
                if (static_cast<double>(most) >= kEnough * static_cast<double>(num_placed)) break;
                const auto pose = wand_of_pair(bundle, sightings, cameras[i], cameras[i + apart]);
                if (!pose) continue;
                wand = {*pose, true};
                const auto count = std::ranges::count_if(sightings, fits);
                if (count <= most) continue;
                most = count;
                best = *pose;
            }
        }
        wand = {best, most > 0};
        std::size_t num_cameras = 0;
        std::uint32_t last = UINT32_MAX;
        for (Sighting& sighting : sightings) {
            sighting.is_used = fits(sighting);
            if (!sighting.is_used || sighting.camera == last) continue;
            last = sighting.camera;
            ++num_cameras;
        }
        if (num_cameras < 2) wand.is_placed = false;
    }
}

}  // namespace atrium::calibrate
