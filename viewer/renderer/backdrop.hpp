#pragma once

#include "core/base/expected.hpp"
#include "core/gl/resources.hpp"
#include "core/gl/shader_program.hpp"
#include "viewer/renderer/object_look.hpp"
#include "viewer/renderer/screen_square.hpp"
#include "viewer/renderer/textures.hpp"
#include "viewer/renderer/view_camera.hpp"

#include <Eigen/Core>

namespace atrium::renderer {

/// Towards the light, of length 1, in the world.
Eigen::Vector3f light_world();

/// What things stand on and before: floors with shadows on them, the ground around, the sky.
class Backdrop {
public:
    /// Side of the floor's square, around the origin, that shadows fall on.
    static constexpr float kShadowExtentM = 10.0f;
    static constexpr int kShadowPx = 512;  // 2 cm a pixel; kFloorFragment blurs by it

    static Expected<Backdrop> create();

    /// Clears the one picture of all shadows on the floor; what is drawn with the shader returned,
    /// which is in use, from then on stands in the light. It wants "world_from_object" and
    /// "darkness": 1 of what is solid.
    const gl::ShaderProgram& begin_shadow();
    /// After it: the shader for instances of rigid things.
    const gl::ShaderProgram& begin_object_shadows();

    /// A plane with its normal up.
    void draw_floor(const View& view, const ObjectLook& look, const Textures& textures);
    /// At a height [m], to the horizon; after the floors, for what they cover of it is not drawn.
    void draw_ground(const View& view, double height_m);
    /// Last: it is behind everything.
    void draw_sky(const EyeView& eye);

private:
    void draw_plane(const View& view,
                    const ObjectLook& look,
                    const Eigen::Vector3f& colour,
                    const Textures& textures);

    gl::ShaderProgram floor_shader_;
    gl::ShaderProgram sky_shader_;
    gl::ShaderProgram shadow_shader_;
    gl::ShaderProgram object_shadow_shader_;
    gl::Framebuffer shadow_;  // white where something stands between the floor and the light
    ScreenSquare square_;
};

}  // namespace atrium::renderer
