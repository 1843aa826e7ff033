#pragma once

#include "core/base/expected.hpp"
#include "core/geometry/pinhole_camera.hpp"
#include "core/image/image.hpp"
#include "simulation/person.hpp"

#include <cstdint>
#include <memory>
#include <vector>

namespace atrium::simulation {

/// Content of a picture.
enum class Scene : std::uint8_t { kEmptyRoom, kPerson };

/// Renders pictures of a simulated room as the cameras of a rig would deliver them: with lens
/// distortion, shadows of people on floor and walls, soft edges and noise. The same arguments
/// give the same bytes.
///
/// Needs no display. Owns a GL context and scratch memory: use an object on one thread only.
/// Several objects may share a thread, or work in parallel.
class RoomRenderer {
public:
    /// `cameras` are in the site frame, with even width and height. Views the empty room once: some
    /// tenths of a second per camera. Error kConfiguration for bad options or cameras, kUnavailable
    /// without OSMesa, and those of `Model::load` with a model.
    static Expected<RoomRenderer> create(std::vector<geometry::CalibratedCamera> cameras,
                                         const RoomOptions& options);

    RoomRenderer(RoomRenderer&&) noexcept;
    RoomRenderer& operator=(RoomRenderer&&) noexcept;
    ~RoomRenderer();

    /// Renders the picture of camera `camera_index` at `time_s`. `shot` distinguishes the noise of
    /// pictures of one instant. `true_mask`, if given, receives the pixels that people cover
    /// by at least half, before noise. Fastest if all cameras of an instant follow each other.
    /// Resizes planes only when sizes change.
    void render(double time_s,
                std::size_t camera_index,
                Scene scene,
                std::uint32_t shot,
                image::YuvImage& out,
                image::Mask* true_mask = nullptr);

    /// Only without `RoomOptions::model`. Its mesh at `time_of_person_s` is what `render` shows.
    const Person& person(std::size_t index = 0) const;
    const std::vector<geometry::CalibratedCamera>& cameras() const;

private:
    struct Impl;
    explicit RoomRenderer(std::unique_ptr<Impl> impl);

    std::unique_ptr<Impl> impl_;
};

}  // namespace atrium::simulation
