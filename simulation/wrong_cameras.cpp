#include "simulation/wrong_cameras.hpp"

#include "core/config/spelling.hpp"
#include "simulation/room_config.hpp"

#include <Eigen/Geometry>

#include <algorithm>
#include <numbers>
#include <string>
#include <vector>

namespace atrium::simulation {
namespace {

Expected<std::optional<std::size_t>> find_named(const std::string& option,
                                                const std::string& name,
                                                std::span<const geometry::CalibratedCamera> rig) {
    if (name.empty()) return std::nullopt;
    std::vector<std::string> names;
    for (const geometry::CalibratedCamera& camera : rig) names.push_back(camera.name);
    const auto found = std::ranges::find(names, name);
    if (found == names.end())
        return make_error(ErrorKind::kConfiguration,
                          option + ": the rig has no camera '" + name +
                              "': " + config::must_be_one_of(names, name));
    return static_cast<std::size_t>(found - names.begin());
}

}  // namespace

geometry::CalibratedCamera bumped(const geometry::CalibratedCamera& camera,
                                  double turn_rad,
                                  double move_m) {
    geometry::CalibratedCamera out = camera;
    // in the camera's axes: about +Y, which points down, and along +X
    const Eigen::Quaterniond turned_from_camera(
        Eigen::AngleAxisd(-turn_rad, Eigen::Vector3d::UnitY()));
    const geometry::RigidTransform& before = camera.camera_from_site;
    out.camera_from_site.rotation = (turned_from_camera * before.rotation).normalized();
    out.camera_from_site.translation =
        turned_from_camera * (before.translation - Eigen::Vector3d(move_m, 0.0, 0.0));
    return out;
}

Expected<WrongCameras> WrongCameras::create(const RoomConfig& config,
                                            std::span<const geometry::CalibratedCamera> rig) {
    const auto bumped = find_named("simulation.bumped_camera", config.bumped_camera, rig);
    if (!bumped) return tl::unexpected(bumped.error());
    const auto late = find_named("simulation.late_camera", config.late_camera, rig);
    if (!late) return tl::unexpected(late.error());
    WrongCameras out;
    out.bumped_ = *bumped;
    out.late_ = *late;
    out.turn_rad_ = config.bumped_turn_deg * std::numbers::pi / 180.0;
    out.move_m_ = 1e-3 * config.bumped_move_mm;
    out.after_s_ = config.bumped_after_s;
    out.late_instants_ = config.late_instants;
    out.num_cameras_ = rig.size();
    return out;
}

std::vector<geometry::CalibratedCamera> WrongCameras::rendered(
    std::span<const geometry::CalibratedCamera> rig) const {
    std::vector<geometry::CalibratedCamera> cameras(rig.begin(), rig.end());
    if (!bumped_) return cameras;
    const geometry::CalibratedCamera moved =
        simulation::bumped(cameras[*bumped_], turn_rad_, move_m_);
    if (after_s_ > 0.0)
        cameras.push_back(moved);
    else
        cameras[*bumped_] = moved;
    return cameras;
}

std::size_t WrongCameras::rendered_index(std::size_t camera, double time_s) const {
    return camera == bumped_ && after_s_ > 0.0 && time_s >= after_s_ ? num_cameras_ : camera;
}

std::size_t WrongCameras::shown_instant(std::size_t camera,
                                        std::size_t instant,
                                        std::size_t num_instants) const {
    const auto num = static_cast<std::ptrdiff_t>(num_instants);
    const std::ptrdiff_t before =
        (static_cast<std::ptrdiff_t>(instant) - late_instants(camera)) % num;
    return static_cast<std::size_t>(before < 0 ? before + num : before);
}

}  // namespace atrium::simulation
