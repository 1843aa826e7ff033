#pragma once

#include "core/base/expected.hpp"
#include "core/geometry/pinhole_camera.hpp"
#include "core/image/image.hpp"
#include "simulation/person.hpp"

#include <cstdint>
#include <memory>
#include <vector>

namespace atrium::simulation {

/// Who is in the picture.
enum class Scene : std::uint8_t { kEmptyRoom, kPerson };

/// Pictures of a simulated room, as the cameras of a rig would deliver them: lens distortion,
/// shadow of the person on floor and walls, softened edges, noise. The same arguments give the same
/// bytes.
///
/// Needs no display. Owns a GL context and scratch memory: one object is used on one thread,
/// several may work at once.
class RoomRenderer {
public:
    /// `cameras` stand in the site frame, with even width and height. Looks once around the empty
    /// room: some tenths of a second per camera. Error kConfiguration for bad options or cameras,
    /// kUnavailable where there is no OSMesa, those of `Model::load` where a model stands there.
    static Expected<RoomRenderer> create(std::vector<geometry::CalibratedCamera> cameras,
                                         const RoomOptions& options);

    RoomRenderer(RoomRenderer&&) noexcept;
    RoomRenderer& operator=(RoomRenderer&&) noexcept;
    ~RoomRenderer();

    /// The picture of camera `camera_index` at `time_s`; `shot` tells apart the noise of pictures
    /// of one instant. `true_mask`, where given, becomes the pixels that the person covers at least
    /// by half, before noise. Fastest when all cameras of an instant follow each other. Planes are
    /// resized only when sizes change.
    void render(double time_s,
                std::size_t camera_index,
                Scene scene,
                std::uint32_t shot,
                image::YuvImage& out,
                image::Mask* true_mask = nullptr);

    /// Only where `RoomOptions::model` is empty.
    const Person& person() const;
    const std::vector<geometry::CalibratedCamera>& cameras() const;

private:
    struct Impl;
    explicit RoomRenderer(std::unique_ptr<Impl> impl);

    std::unique_ptr<Impl> impl_;
};

}  // namespace atrium::simulation
