#pragma once

#include "core/base/expected.hpp"
#include "core/gl/resources.hpp"
#include "core/gl/shader_program.hpp"
#include "viewer/renderer/floor_cells.hpp"
#include "viewer/renderer/object_look.hpp"
#include "viewer/renderer/screen_square.hpp"
#include "viewer/renderer/shadow_cover.hpp"
#include "viewer/renderer/textures.hpp"
#include "viewer/renderer/view_camera.hpp"

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace atrium::renderer {

/// Towards the light, of length 1, in the world.
Eigen::Vector3f light_world();

/// What things stand on and before: floors with shadows on them, the ground around, the sky.
class Backdrop {
public:
    /// Side of the floor's square, around the origin, that shadows fall on.
    static constexpr float kShadowExtentM = 10.0f;
    static constexpr int kShadowPx = 512;  // 2 cm a pixel

    static Expected<Backdrop> create();

    /// Clears the one picture of all shadows on the floor.
    void begin_shadows();
    /// Of what covers these pixels of it and is so dark, in [0, 1]; in place of what was there.
    void add_shadow(std::span<const PixelRun> runs, double darkness);
    /// After those: what is drawn with the shader returned, which is in use, from then on stands in
    /// the light. It wants "world_from_object" and "darkness": 1 of what is solid.
    const gl::ShaderProgram& begin_thing_shadows();
    /// After it: the shader for instances of rigid things.
    const gl::ShaderProgram& begin_object_shadows();
    /// Where the shadow of something in this box may fall: shadows are looked up nowhere else.
    void add_shadow_of(const Eigen::AlignedBox3d& box_world);
    /// When all shadows are drawn: blurs them.
    void end_shadows();

    /// Off: floors are lit everywhere, and the picture of the shadows is not used.
    void set_shadows(bool are_on) { are_shadows_on_ = are_on; }

    /// Floors, planes with their normal up, the ground around and below them, to the horizon, and
    /// the sky: after everything else, for what that hides is not drawn. Without shadows.
    void draw(const EyeView& eye,
              std::span<const ObjectLook* const> floors,
              const Textures& textures);
    /// The same, with its depth, for an eye that has all of `target`, and before everything else:
    /// copied, which takes a fraction of the time, if that eye sees what it saw last time. Else
    /// returns false and does nothing.
    bool copy(const EyeView& eye,
              std::span<const ObjectLook* const> floors,
              const Textures& textures,
              const gl::Framebuffer& target);
    /// Floors or their textures are no longer what they were.
    void changed() { is_kept_ = false; }
    /// After either, and all that stands on them.
    void draw_shadows(const View& view, std::span<const ObjectLook* const> floors);

private:
    void draw_plane(const View& view,
                    const ObjectLook& look,
                    const Eigen::Vector3f& colour,
                    const Textures& textures);
    void draw_sky(const EyeView& eye);
    void draw_shadow(const ObjectLook& look);
    void draw_triangles() const;

    std::array<gl::ShaderProgram, 2> floor_shaders_;  // plain, textured
    gl::ShaderProgram floor_shadow_shader_;
    gl::ShaderProgram sky_shader_;
    gl::ShaderProgram shadow_shader_;
    gl::ShaderProgram object_shadow_shader_;
    gl::ShaderProgram blur_shader_;
    std::vector<std::uint8_t> painted_;  // what `shadow_` begins with
    gl::Framebuffer shadow_;   // white where something stands between the floor and the light
    gl::Framebuffer blurred_;  // the same with soft edges
    bool are_shadows_on_ = true;
    FloorCells shadowed_{kShadowExtentM};     // where `blurred_` may not be black
    std::vector<Eigen::Vector3f> triangles_;  // scratch
    gl::VertexArray triangles_layout_ = gl::make_vertex_array();
    gl::Buffer triangles_corners_ = gl::make_buffer();
    ScreenSquare square_;

    gl::Framebuffer kept_;  // of `draw`
    std::optional<EyeView> last_eye_;
    bool is_kept_ = false;  // as `last_eye_` sees it
};

}  // namespace atrium::renderer
