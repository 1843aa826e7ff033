#pragma once

#include "core/geometry/rigid_transform.hpp"
#include "simulation/rendered_room.hpp"
#include "simulation/sensor_noise.hpp"

#include <Eigen/Core>

#include <numbers>
#include <optional>
#include <vector>

namespace atrium::simulation {

struct BoardRoomOptions {
    double square_m = 0.16;  // as `calibrate print-board --paper a0` prints it
    double noise_lsb = 2.0;  // standard deviation [grey levels]
    std::uint64_t seed = 1;  // of the motion and the noise
    bool lies = false;       // on the floor at the site's origin, along its axes, and at rest
};

/// The board that `calibrate print-board` makes without options, in its frame: the origin at the
/// outer corner of its squares at the bottom left, +X to the right, +Y up the page, +Z to whom
/// looks at it. Returns whether the print is black there; nullopt beside the plate, which is half a
/// square larger.
std::optional<bool> is_black(const Eigen::Vector2d& p_board, double square_m);
inline constexpr int kBoardColumns = 5, kBoardRows = 7;

/// An empty room in which a calibration board is carried around and shown to all cameras, one
/// after the other and two at a time, leaning to all sides: once around in half a minute. Who
/// carries it is not seen.
class BoardRoom final : public RenderedRoom {
public:
    /// The board moves about the middle of `rig.bounds_site`.
    BoardRoom(const config::Rig& rig, const BoardRoomOptions& options);

    void render(double time_s, std::size_t camera, image::Plane& out) const override;
    void render_empty(std::uint64_t shot, std::size_t camera, image::Plane& out) const override;

    /// `p_site = site_from_board(time) * p_board`.
    geometry::RigidTransform site_from_board(double time_s) const;

private:
    void draw_board(const geometry::RigidTransform& camera_from_board,
                    const geometry::PinholeCamera& lens,
                    image::Plane& out) const;
    void add_noise(std::uint64_t picture, image::Plane& out) const;

    std::vector<geometry::CalibratedCamera> cameras_;
    std::vector<Eigen::Vector3d> around_;  // centres of the cameras, in their order around the room
    geometry::Aabb bounds_site_;
    BoardRoomOptions options_;
    SensorNoise noise_;
    std::vector<double> phases_rad_;
    std::vector<image::Plane> empty_;  // per camera, without noise
};

}  // namespace atrium::simulation
