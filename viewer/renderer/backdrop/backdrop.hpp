#pragma once

#include "core/base/expected.hpp"
#include "core/gl/resources.hpp"
#include "core/gl/shader_program.hpp"
#include "viewer/renderer/backdrop/floor_cells.hpp"
#include "viewer/renderer/backdrop/shadow_heights.hpp"
#include "viewer/renderer/drawing/object_look.hpp"
#include "viewer/renderer/drawing/screen_square.hpp"
#include "viewer/renderer/drawing/textures.hpp"
#include "viewer/renderer/drawing/triangle_coverage.hpp"
#include "viewer/renderer/drawing/view_camera.hpp"

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace atrium::renderer {

/// Direction towards the light, length 1, in the world.
Eigen::Vector3f light_world();

/// Draws floors with shadows, the ground around them and the sky, and keeps the shadow map: the
/// floor seen along the light, with the height of what blocks the light. What is lower gets shadow.
class Backdrop {
public:
    /// Side of the square of floor around the origin that receives shadows [m].
    static constexpr float kShadowExtentM = 10.0f;
    static constexpr int kShadowPx = 512;  // 2 cm per pixel

    static Expected<Backdrop> create();

    /// Clears the shadow map of the floor.
    void begin_shadows();
    /// Sets the darkness in [0, 1] of these pixels of the shadow map, and how high what casts it
    /// is.
    void add_shadow(std::span<const PixelRun> runs, const ShadowHeights& heights, double darkness);
    /// Call after `add_shadow`. Returns the bound shader that draws solid shapes into the shadow
    /// map. Set "world_from_object" and "darkness"; 1 for a solid object.
    const gl::ShaderProgram& begin_solid_shadows();
    /// Call after `begin_solid_shadows`. Returns the shader for instances of rigid objects.
    const gl::ShaderProgram& begin_object_shadows();
    /// Marks the floor that the shadow of this box may cover. The shadow map is sampled only there.
    void add_shadow_of(const Eigen::AlignedBox3d& box_world);
    /// Call after all shadows are drawn. Blurs the shadow map.
    void end_shadows();

    /// Off: no floor has shadows, and the shadow map is not used.
    void set_shadows(bool are_on) { are_shadows_on_ = are_on; }

    /// Draws floors (planes with their normal up), the ground below and around them to the horizon,
    /// and the sky, without shadows. Call it after everything else, so hidden pixels are not
    /// shaded.
    void draw(const EyeView& eye,
              std::span<const ObjectLook* const> floors,
              const Textures& textures);
    /// Copies the backdrop and its depth into `target`, for an eye that covers all of it. Call it
    /// before everything else. Much faster than `draw`, but works only if the eye has not moved
    /// since the last call; otherwise returns false without effect.
    bool copy(const EyeView& eye,
              std::span<const ObjectLook* const> floors,
              const Textures& textures,
              const gl::Framebuffer& target);
    /// Call when floors or their textures change.
    void changed() { is_kept_ = false; }
    /// Draws the shadows. Call after `draw` or `copy` and all objects on the floor.
    void draw_shadows(const View& view, std::span<const ObjectLook* const> floors);
    /// Binds the shader that draws the shadows on objects once more, with kObjectVertex. False if
    /// there are none. Call `end_received_shadows` after them.
    bool begin_received_shadows(const View& view);
    void end_received_shadows();

private:
    void draw_plane(const View& view,
                    const ObjectLook& look,
                    const Eigen::Vector3f& colour,
                    const Textures& textures);
    void draw_sky(const EyeView& eye);
    void draw_shadow(const ObjectLook& look);
    void begin_darkening(const gl::ShaderProgram& shader, const View& view);
    void end_darkening();
    void draw_triangles() const;

    std::array<gl::ShaderProgram, 2> floor_shaders_;  // plain, textured
    gl::ShaderProgram floor_shadow_shader_;
    gl::ShaderProgram received_shadow_shader_;
    gl::ShaderProgram sky_shader_;
    gl::ShaderProgram shadow_shader_;
    gl::ShaderProgram object_shadow_shader_;
    gl::ShaderProgram blur_shader_;
    std::vector<std::uint8_t> painted_;  // initial content of `shadow_`
    gl::Framebuffer shadow_;             // red where an object blocks the light; green: its height
    gl::Framebuffer blurred_;            // blurred `shadow_`
    bool are_shadows_on_ = true;
    FloorCells shadowed_{kShadowExtentM};     // cells where `blurred_` may not be black
    std::vector<Eigen::Vector3f> triangles_;  // scratch
    gl::VertexArray triangles_layout_ = gl::make_vertex_array();
    gl::Buffer triangles_corners_ = gl::make_buffer();
    ScreenSquare square_;

    gl::Framebuffer kept_;  // result of `draw`
    std::optional<EyeView> last_eye_;
    bool is_kept_ = false;  // `kept_` is what `last_eye_` sees
};

}  // namespace atrium::renderer
