#pragma once

#include "core/config/rig.hpp"
#include "core/image/image.hpp"

#include <cstddef>
#include <cstdint>
#include <memory>

namespace atrium::simulation {

struct RoomConfig;

/// A simulated room for calibration. Its grey pictures are rendered when they are due, so that no
/// loop has to be kept. The same options give the same pictures, in any order. Thread-safe.
class RenderedRoom {
public:
    virtual ~RenderedRoom() = default;

    /// Draws the picture that camera `camera` exposes around `time_s`; of even size.
    virtual void render(double time_s, std::size_t camera, image::Plane& out) const = 0;

    /// Draws the empty room; `shot` distinguishes the noise of several pictures.
    virtual void render_empty(std::uint64_t shot, std::size_t camera, image::Plane& out) const = 0;

    /// Returns true if this picture is lost, by chance.
    virtual bool is_lost(double /*time_s*/, std::size_t /*camera*/) const { return false; }
};

/// The room that `simulation.shows` asks for; null if it shows a person. `rig`: the cameras to
/// render.
std::unique_ptr<const RenderedRoom> rendered_room(const config::Rig& rig, const RoomConfig& config);

}  // namespace atrium::simulation
