#include "viewer/renderer/backdrop.hpp"

#include "viewer/renderer/shaders.hpp"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <glad/gl.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

namespace atrium::renderer {
namespace {

// sRGB-encoded
const Eigen::Vector3f kHorizon(0.82f, 0.85f, 0.88f);
const Eigen::Vector3f kZenith(0.45f, 0.54f, 0.66f);
const Eigen::Vector3f kGroundColour(0.70f, 0.69f, 0.67f);
constexpr double kGroundSizeM = 60.0;
constexpr float kHorizonAbove = 0.1f;  // sine below the horizon from which the sky's colour rises

Eigen::Vector3f encode_srgb(const Eigen::Vector3d& linear) {
    return linear
        .unaryExpr([](double v) {
            v = std::clamp(v, 0.0, 1.0);
            return v <= 0.0031308 ? 12.92 * v : 1.055 * std::pow(v, 1.0 / 2.4) - 0.055;
        })
        .cast<float>();
}

}  // namespace

Eigen::Vector3f light_world() { return Eigen::Vector3f(0.30f, -0.22f, 1.0f).normalized(); }

Expected<Backdrop> Backdrop::create() {
    Backdrop made;
    struct Source {
        gl::ShaderProgram& program;
        const char* name;
        std::string vertex;
        const char* fragment;
    };
    for (const Source& source :
         {Source{made.floor_shader_, "floor", shaders::kFloorVertex, shaders::kFloorFragment},
          Source{made.sky_shader_,
                 "background",
                 shaders::kBackgroundVertex,
                 shaders::kBackgroundFragment},
          Source{made.shadow_shader_,
                 "shadow",
                 shaders::shadow_vertex(shaders::Placed::kAllAlike),
                 shaders::kShadowFragment},
          Source{made.object_shadow_shader_,
                 "object_shadow",
                 shaders::shadow_vertex(shaders::Placed::kEachInstance),
                 shaders::kShadowFragment}}) {
        auto program = gl::ShaderProgram::create(source.name, source.vertex, source.fragment);
        if (!program) return tl::unexpected(program.error());
        source.program = std::move(*program);
    }
    auto shadow = gl::make_framebuffer(kShadowPx, kShadowPx, gl::PixelFormat::kR8);
    if (!shadow) return tl::unexpected(shadow.error());
    made.shadow_ = std::move(*shadow);
    return made;
}

namespace {

const gl::ShaderProgram& begin(const gl::ShaderProgram& shader) {
    shader.use();
    shader.set("light", light_world());
    shader.set("shadow_extent", Backdrop::kShadowExtentM);
    return shader;
}

}  // namespace

const gl::ShaderProgram& Backdrop::begin_shadow() {
    shadow_.bind();
    glDisable(GL_DEPTH_TEST);
    glDisable(GL_CULL_FACE);
    glClearColor(0.0f, 0.0f, 0.0f, 0.0f);
    glClear(GL_COLOR_BUFFER_BIT);
    return begin(shadow_shader_);
}

const gl::ShaderProgram& Backdrop::begin_object_shadows() {
    begin(object_shadow_shader_).set("darkness", 1.0f);
    return object_shadow_shader_;
}

void Backdrop::draw_plane(const View& view,
                          const ObjectLook& look,
                          const Eigen::Vector3f& colour,
                          const Textures& textures) {
    const double height = look.world_from_object.translation.z();
    floor_shader_.use();
    floor_shader_.set("clip_from_world", Eigen::Matrix4f(view.clip_from_world.cast<float>()));
    floor_shader_.set("world_from_floor",
                      Eigen::Matrix4f(look.world_from_object.matrix().cast<float>()));
    floor_shader_.set("half_size", Eigen::Vector2f((0.5 * look.size_m.head<2>()).cast<float>()));
    floor_shader_.set("colour", colour);
    floor_shader_.set("horizon", kHorizon);
    textures.use(look.texture, floor_shader_, 1);
    gl::bind_texture(0, shadow_.colour);
    floor_shader_.set("shadow", 0);
    floor_shader_.set("shadow_extent", kShadowExtentM);
    // shadows are cast onto the ground; a shelf somewhere above has none. Four samples are summed.
    floor_shader_.set("shadow_strength", std::abs(height) < 0.05 ? 0.30f / 4.0f : 0.0f);
    // squared distances from the origin between which the floor fades into the horizon
    const float begin = 5.0f * 5.0f;
    const float end = 22.0f * 22.0f;
    floor_shader_.set("fade", Eigen::Vector2f(begin, 1.0f / (end - begin)));
    square_.draw();
}

void Backdrop::draw_floor(const View& view, const ObjectLook& look, const Textures& textures) {
    draw_plane(view, look, encode_srgb(look.colour), textures);
}

void Backdrop::draw_ground(const View& view, double height_m) {
    ObjectLook ground{.shape = ShapeKind::kPlane};
    ground.size_m = {kGroundSizeM, kGroundSizeM, 0.0};
    ground.world_from_object.translation.z() = height_m;
    draw_plane(view, ground, kGroundColour, {});
}

void Backdrop::draw_sky(const EyeView& eye) {
    // the sine of the elevation at the corners, where a ray of each leaves; linear enough between
    const Eigen::Matrix4d world_from_clip = eye.clip_from_world().inverse();
    const auto sine_at = [&](double x, double y) {
        const Eigen::Vector4d far = world_from_clip * Eigen::Vector4d(x, y, 1.0, 1.0);
        const Eigen::Vector3d way = far.head<3>() / far.w() - eye.eye_world();
        return static_cast<float>(way.normalized().z()) + kHorizonAbove;
    };
    sky_shader_.use();
    sky_shader_.set("lower", Eigen::Vector2f(sine_at(-1.0, -1.0), sine_at(1.0, -1.0)));
    sky_shader_.set("upper", Eigen::Vector2f(sine_at(-1.0, 1.0), sine_at(1.0, 1.0)));
    sky_shader_.set("horizon", kHorizon);
    sky_shader_.set("zenith", kZenith);
    square_.draw();
}

}  // namespace atrium::renderer
