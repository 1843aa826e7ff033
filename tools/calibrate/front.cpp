#include "tools/calibrate/front.hpp"

#include <Eigen/Geometry>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace atrium::calibrate {
namespace {

// Seen from the origin, counter-clockwise from +X.
double direction_rad(const geometry::CalibratedCamera& camera) {
    const Eigen::Vector3d place = camera.centre_site();
    return std::atan2(place.y(), place.x());
}

}  // namespace

bool turn_front_towards(const std::string& name, std::vector<geometry::CalibratedCamera>& cameras) {
    const auto camera = std::ranges::find(cameras, name, &geometry::CalibratedCamera::name);
    if (camera == cameras.end()) return false;
    const geometry::RigidTransform old_from_new{
        Eigen::Quaterniond(Eigen::AngleAxisd(direction_rad(*camera), Eigen::Vector3d::UnitZ())),
        Eigen::Vector3d::Zero()};
    for (geometry::CalibratedCamera& one : cameras)
        one.camera_from_site = one.camera_from_site * old_from_new;
    return true;
}

std::string front_camera(const std::vector<geometry::CalibratedCamera>& cameras) {
    return std::ranges::min_element(cameras,
                                    {},
                                    [](const geometry::CalibratedCamera& camera) {
                                        return std::abs(direction_rad(camera));
                                    })
        ->name;
}

std::string front_text(const std::string& name) {
    return fmt::format("front: people who look towards '{}' look along +X, into the world", name);
}

}  // namespace atrium::calibrate
