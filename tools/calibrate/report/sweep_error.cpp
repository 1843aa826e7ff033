#include "tools/calibrate/report/sweep_error.hpp"

#include "tools/calibrate/adjust/place_wands.hpp"
#include "tools/calibrate/adjust/rays.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace atrium::calibrate {
namespace {

// Light by light of one instant.
class InstantError {
public:
    InstantError(const std::vector<const geometry::CalibratedCamera*>& cameras,
                 std::span<const Sighting> sightings)
        : cameras_(cameras), sightings_(sightings) {}

    void add(std::uint32_t light, double& sum, double& count) const {
        std::vector<SeenRay> rays;
        std::vector<const Sighting*> used;
        for (const Sighting& sighting : sightings_) {
            const geometry::CalibratedCamera* camera = cameras_[sighting.camera];
            if (sighting.light != light || !sighting.is_used || camera == nullptr) continue;
            const auto ray =
                seen_ray(camera->intrinsics, camera->camera_from_site.inverse(), sighting.px);
            if (!ray) continue;
            rays.push_back(*ray);
            used.push_back(&sighting);
        }
        const auto point = nearest_to_rays(rays);
        if (!point) return;
        for (const Sighting* sighting : used) {
            const geometry::CalibratedCamera& camera = *cameras_[sighting->camera];
            const Eigen::Vector3d seen = camera.camera_from_site * *point;
            if (seen.z() <= 0.0) continue;
            const geometry::PinholeCamera& lens = camera.intrinsics;
            sum += (lens.distort(lens.project(seen)) - sighting->px).squaredNorm();
            count += 2.0;
        }
    }

private:
    const std::vector<const geometry::CalibratedCamera*>& cameras_;
    std::span<const Sighting> sightings_;
};

}  // namespace

std::optional<double> sweep_error_px(const Bundle& seen, const config::Rig& rig) {
    std::vector<const geometry::CalibratedCamera*> cameras;
    for (const BundleCamera& camera : seen.cameras) {
        const auto found =
            std::ranges::find(rig.cameras, camera.name, &geometry::CalibratedCamera::name);
        cameras.push_back(found == rig.cameras.end() ? nullptr : &*found);
    }
    double sum = 0.0, count = 0.0;
    for (const InstantRange& range : ranges_of(seen)) {
        const InstantError instant(cameras,
                                   {seen.sightings.data() + range.begin, range.end - range.begin});
        for (std::uint32_t light = 0; light < seen.wand.size(); ++light)
            instant.add(light, sum, count);
    }
    if (count == 0.0) return std::nullopt;
    return std::sqrt(sum / count);
}

}  // namespace atrium::calibrate
