#pragma once

#include "core/base/expected.hpp"
#include "core/gl/offscreen_context.hpp"
#include "core/image/image.hpp"
#include "simulation/model.hpp"
#include "simulation/person.hpp"
#include "simulation/room.hpp"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

namespace atrium::simulation {

/// Draws people or models without the room, with OSMesa. Owns its context: use it on one thread.
class PersonPainter {
public:
    /// Pictures may be up to `max_width` by `max_height`.
    static Expected<PersonPainter> create(std::span<const Person> people,
                                          const Room& room,
                                          int max_width,
                                          int max_height);
    static Expected<PersonPainter> create(std::span<const Model> models,
                                          const Room& room,
                                          int max_width,
                                          int max_height);

    PersonPainter(PersonPainter&&) noexcept;
    PersonPainter& operator=(PersonPainter&&) noexcept;
    ~PersonPainter();

    /// `skin`: that of the person or model `index`.
    void set_pose(std::size_t index, const PosedSkin& skin);

    /// Draws `region` of the camera's picture. Returns RGBA rows of `region.width`, top row first:
    /// alpha is the fraction of the pixel that people cover, and colours are premultiplied.
    /// The span is valid until the next call.
    std::span<const std::uint8_t> draw(const geometry::CalibratedCamera& camera,
                                       const image::PixelRect& region);

    /// Draws the people's blurred shadow, 0 to 255, in pixels of `Room::shadow_camera`.
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
