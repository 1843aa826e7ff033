#include "tools/calibrate/adjust/place_camera.hpp"

#include <opencv2/calib3d.hpp>

#include <vector>

namespace atrium::calibrate {
namespace {

struct KnownLights {
    std::vector<cv::Point3d> world;
    std::vector<Eigen::Vector2d> px;
};

KnownLights lights_of(const Bundle& bundle,
                      std::size_t camera,
                      std::span<const InstantRange> ranges,
                      std::span<const std::uint32_t> instants) {
    KnownLights lights;
    for (const std::uint32_t instant : instants) {
        if (!bundle.wands[instant].is_placed) continue;
        for (std::size_t s = ranges[instant].begin; s < ranges[instant].end; ++s) {
            const Sighting& sighting = bundle.sightings[s];
            if (sighting.camera != camera) continue;
            const Eigen::Vector3d light = light_world(bundle, sighting);
            lights.world.emplace_back(light.x(), light.y(), light.z());
            lights.px.push_back(sighting.px);
        }
    }
    return lights;
}

// Returns the number of lights that agree.
std::size_t try_lens(const KnownLights& lights, BundleCamera& camera) {
    std::vector<cv::Point2d> normal;
    const geometry::PinholeCamera lens = camera.intrinsics();
    for (const Eigen::Vector2d& px : lights.px) {
        const Eigen::Vector3d ray = lens.ray_camera(lens.undistort(px).value_or(px));
        normal.emplace_back(ray.x(), ray.y());
    }
    cv::Mat turn, shift;
    std::vector<int> inliers;
    constexpr int kTries = 200;
    constexpr double kConfidence = 0.999;
    const auto most_off = static_cast<float>(kCoarse * camera.width / camera.lens[0]);
    if (!cv::solvePnPRansac(lights.world,
                            normal,
                            cv::Mat::eye(3, 3, CV_64F),
                            cv::noArray(),
                            turn,
                            shift,
                            false,
                            kTries,
                            most_off,
                            kConfidence,
                            inliers))
        return 0;
    for (int k = 0; k < 3; ++k) {
        camera.pose[static_cast<std::size_t>(k)] = turn.at<double>(k);
        camera.pose[static_cast<std::size_t>(3 + k)] = shift.at<double>(k);
    }
    return inliers.size();
}

}  // namespace

bool place_camera(Bundle& bundle,
                  std::size_t index,
                  std::span<const InstantRange> ranges,
                  std::span<const std::uint32_t> instants) {
    BundleCamera& camera = bundle.cameras[index];
    const KnownLights lights = lights_of(bundle, index, ranges, instants);
    if (lights.px.size() < kMinShared / 2) return false;
    std::size_t most = 0;
    BundleCamera best = camera;
    for (const double scale : kFocalScales) {
        BundleCamera tried = camera;
        tried.lens[0] *= scale;
        const std::size_t num = try_lens(lights, tried);
        if (num <= most) continue;
        most = num;
        best = tried;
    }
    if (most < kMinShared / 2 || 2 * most < lights.px.size()) return false;
    camera = best;
    camera.is_placed = true;
    return true;
}

}  // namespace atrium::calibrate
