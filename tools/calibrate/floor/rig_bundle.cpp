#include "tools/calibrate/floor/rig_bundle.hpp"

#include "tools/calibrate/recording/words.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace atrium::calibrate {

std::vector<BundleCamera> ideal_cameras(const config::Rig& rig) {
    std::vector<BundleCamera> cameras;
    for (const geometry::CalibratedCamera& camera : rig.cameras) {
        BundleCamera ideal;
        ideal.name = camera.name;
        ideal.width = camera.intrinsics.width;
        ideal.height = camera.intrinsics.height;
        ideal.lens = {camera.intrinsics.fx, camera.intrinsics.cx, camera.intrinsics.cy};
        ideal.set_camera_from_world(camera.camera_from_site);
        ideal.is_placed = true;
        cameras.push_back(std::move(ideal));
    }
    return cameras;
}

std::optional<Eigen::Vector2d> undistorted(const geometry::PinholeCamera& lens,
                                           const Eigen::Vector2d& px) {
    const auto linear = lens.undistort(px);
    if (!linear) return std::nullopt;
    const Eigen::Vector3d ray = lens.ray_camera(*linear);
    return Eigen::Vector2d(lens.fx * ray.x() + lens.cx, lens.fx * ray.y() + lens.cy);
}

Expected<std::size_t> camera_index(const config::Rig& rig, const std::string& name) {
    std::vector<std::string> names;
    for (std::size_t i = 0; i < rig.cameras.size(); ++i) {
        if (rig.cameras[i].name == name) return i;
        names.push_back(rig.cameras[i].name);
    }
    return make_error(ErrorKind::kConfiguration,
                      fmt::format("the rig has no camera '{}'; it has {}", name, listed(names)));
}

}  // namespace atrium::calibrate
