#pragma once

#include "core/base/expected.hpp"
#include "core/gl/offscreen_context.hpp"
#include "core/image/image.hpp"
#include "simulation/model.hpp"
#include "simulation/person.hpp"
#include "simulation/room.hpp"

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

namespace atrium::simulation {

/// Draws a person or a model without the room, with OSMesa. Owns its context: use it on one thread.
class PersonPainter {
public:
    /// Pictures may be up to `max_width` by `max_height`.
    static Expected<PersonPainter> create(const Person& person,
                                          const Room& room,
                                          int max_width,
                                          int max_height);
    static Expected<PersonPainter> create(const Model& model,
                                          const Room& room,
                                          int max_width,
                                          int max_height);

    PersonPainter(PersonPainter&&) noexcept;
    PersonPainter& operator=(PersonPainter&&) noexcept;
    ~PersonPainter();

    void set_pose(const PosedSkin& skin);

    /// Draws `region` of the camera's picture. Returns RGBA rows of `region.width`, top row first:
    /// alpha is the fraction of the pixel that the person covers, and colours are premultiplied.
    /// The span is valid until the next call.
    std::span<const std::uint8_t> draw(const geometry::CalibratedCamera& camera,
                                       const image::PixelRect& region);

    /// Draws the person's blurred shadow, 0 to 255, in pixels of `Room::shadow_camera`.
    std::span<const std::uint8_t> draw_shadow();

private:
    struct Impl;
    explicit PersonPainter(std::unique_ptr<Impl> impl);
    static Expected<std::unique_ptr<Impl>> prepare(const char* fragment_shader,
                                                   const Room& room,
                                                   int max_width,
                                                   int max_height);

    std::unique_ptr<Impl> impl_;
};

}  // namespace atrium::simulation
