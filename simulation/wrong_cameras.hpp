#pragma once

#include "core/base/expected.hpp"
#include "core/geometry/pinhole_camera.hpp"

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

namespace atrium::simulation {

struct RoomConfig;

/// In what the cameras of a simulated room are not as the rig says: one was bumped, or one is late.
/// By default all are right.
class WrongCameras {
public:
    WrongCameras() = default;
    /// Finds the cameras that the options name. Error kConfiguration if `rig` has none of that
    /// name.
    static Expected<WrongCameras> create(const RoomConfig& config,
                                         std::span<const geometry::CalibratedCamera> rig);

    /// The cameras to render: those of `rig`, where they really are. One that is bumped later is
    /// there twice: first as in `rig`, and again at the end.
    std::vector<geometry::CalibratedCamera> rendered(
        std::span<const geometry::CalibratedCamera> rig) const;

    /// Which of the `rendered` cameras shows what `camera` of the rig sees at `time_s`, from the
    /// beginning [s].
    std::size_t rendered_index(std::size_t camera, double time_s) const;

    /// The pictures of this camera show what was so many instants before.
    int late_instants(std::size_t camera) const { return camera == late_ ? late_instants_ : 0; }

    /// Which of the `num_instants` of a loop a camera shows at `instant`.
    std::size_t shown_instant(std::size_t camera,
                              std::size_t instant,
                              std::size_t num_instants) const;

private:
    std::optional<std::size_t> bumped_, late_;
    double turn_rad_ = 0.0, move_m_ = 0.0, after_s_ = 0.0;
    int late_instants_ = 0;
    std::size_t num_cameras_ = 0;
};

/// Turns a camera about its centre to the right of its picture, and moves its centre that way.
geometry::CalibratedCamera bumped(const geometry::CalibratedCamera& camera,
                                  double turn_rad,
                                  double move_m);

}  // namespace atrium::simulation
