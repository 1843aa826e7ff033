#pragma once

#include "core/config/rig.hpp"
#include "core/geometry/rigid_transform.hpp"
#include "core/image/image.hpp"
#include "simulation/rendered_room.hpp"
#include "simulation/sensor_noise.hpp"

#include <Eigen/Core>

#include <cstdint>
#include <optional>
#include <vector>

namespace atrium::simulation {

struct WandRoomOptions {
    double exposure_ms = 2.0;   // lights that move are streaks of this time
    double lost_percent = 0.0;  // of the pictures
    double noise_lsb = 2.0;     // standard deviation [grey levels]
    std::uint64_t seed = 1;     // of the motion, the lamps and the noise
    /// On the floor, at three places in turn: first light 0 at the site's origin and the others on
    /// its +X.
    bool lies = false;
};

/// A dark room in which somebody sweeps a calibration wand: four lights on a line, at 0, 10, 30 and
/// 60 cm. Lamps, their reflections and hot pixels are in the pictures, too, but no people.
/// Renders a picture in about a millisecond per megapixel.
class WandRoom final : public RenderedRoom {
public:
    /// The wand moves within `rig.bounds_site`. Cameras of one name have the same lamps and hot
    /// pixels.
    WandRoom(const config::Rig& rig, const WandRoomOptions& options);

    void render(double time_s, std::size_t camera, image::Plane& out) const override;
    void render_empty(std::uint64_t shot, std::size_t camera, image::Plane& out) const override;
    bool is_lost(double time_s, std::size_t camera) const override;

    /// Where the lights are in the middle of the exposure, in the picture of a camera, distorted;
    /// nullopt for those outside of it.
    std::vector<std::optional<Eigen::Vector2d>> lights_px(double time_s, std::size_t camera) const;

    /// `p_site = site_from_wand(time) * p_wand`; light 0 is the origin, the others lie on +X.
    geometry::RigidTransform site_from_wand(double time_s) const;

private:
    image::Plane scenery(const geometry::PinholeCamera& lens, std::uint64_t seed) const;
    void add_noise(std::uint64_t picture, image::Plane& out) const;
    void draw_light(double time_s,
                    const geometry::CalibratedCamera& camera,
                    const Eigen::Vector3d& p_wand,
                    image::Plane& out) const;

    std::vector<geometry::CalibratedCamera> cameras_;
    geometry::Aabb bounds_site_;
    WandRoomOptions options_;
    SensorNoise noise_;
    std::vector<double> phases_rad_;
    std::vector<image::Plane> scenery_;  // per camera, without the wand and without noise
};

/// Places of the lights [m], as of the default wand of `calibrate wand`.
std::vector<Eigen::Vector3d> lights_of_wand();

}  // namespace atrium::simulation
