#include "viewer/renderer/backdrop/backdrop.hpp"

#include "viewer/renderer/drawing/shaders.hpp"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <glad/gl.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

namespace atrium::renderer {
namespace {

// sRGB
const Eigen::Vector3f kHorizon(0.82f, 0.85f, 0.88f);
const Eigen::Vector3f kZenith(0.45f, 0.54f, 0.66f);
const Eigen::Vector3f kGroundColour(0.70f, 0.69f, 0.67f);
constexpr double kGroundSizeM = 60.0;
constexpr double kBlurM = 3.0 * Backdrop::kShadowExtentM / Backdrop::kShadowPx;  // with some margin
constexpr float kFadeBegin = 5.0f * 5.0f;
constexpr float kFadeEnd = 22.0f * 22.0f;
// squared distances from the origin between which the floor fades into the horizon
const Eigen::Vector2f kFade(kFadeBegin, 1.0f / (kFadeEnd - kFadeBegin));
// sine of the angle below the horizon where the sky gradient starts
constexpr float kHorizonAbove = 0.1f;

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
         {Source{made.sky_shader_,
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
                 shaders::kShadowFragment},
          Source{made.blur_shader_, "blur", shaders::kBlurVertex, shaders::kBlurFragment},
          Source{made.floor_shadow_shader_,
                 "floor_shadow",
                 shaders::kFloorShadowVertex,
                 shaders::kFloorShadowFragment},
          Source{made.received_shadow_shader_,
                 "received_shadow",
                 shaders::kObjectVertex,
                 shaders::kReceivedShadowFragment}}) {
        auto program = gl::ShaderProgram::create(source.name, source.vertex, source.fragment);
        if (!program) return tl::unexpected(program.error());
        source.program = std::move(*program);
    }
    for (const bool is_textured : {false, true}) {
        auto program = gl::ShaderProgram::create(
            "floor", shaders::kFloorVertex, shaders::floor_fragment(is_textured));
        if (!program) return tl::unexpected(program.error());
        made.floor_shaders_[is_textured ? 1 : 0] = std::move(*program);
    }
    glBindVertexArray(made.triangles_layout_.id());
    glBindBuffer(GL_ARRAY_BUFFER, made.triangles_corners_.id());
    gl::float_attribute(0, 3, sizeof(Eigen::Vector3f), 0);
    glBindVertexArray(0);
    for (gl::Framebuffer* picture : {&made.shadow_, &made.blurred_}) {
        auto created = gl::make_framebuffer(kShadowPx, kShadowPx, gl::PixelFormat::kRg8);
        if (!created) return tl::unexpected(created.error());
        *picture = std::move(*created);
    }
    return made;
}

namespace {

const gl::ShaderProgram& begin(const gl::ShaderProgram& shader) {
    shader.use();
    shader.set("light", light_world());
    shader.set("shadow_extent", Backdrop::kShadowExtentM);
    shader.set("most_height", ShadowHeights::kMostM);
    return shader;
}

}  // namespace

void Backdrop::begin_shadows() {
    shadowed_.clear();
    painted_.assign(std::size_t{2} * kShadowPx * kShadowPx, 0);
}

// Fills the map on the CPU: as triangles, each run would cost a software renderer two triangles.
void Backdrop::add_shadow(std::span<const PixelRun> runs,
                          const ShadowHeights& heights,
                          double darkness) {
    const auto at = [](int x, int y) -> Eigen::Vector2d {
        return (Eigen::Array2d(x, y) - 0.5 * kShadowPx) * (kShadowExtentM / kShadowPx);
    };
    const auto value = static_cast<std::uint8_t>(std::lround(255.0 * darkness));
    for (const PixelRun& run : runs) {
        std::uint8_t* row = painted_.data() + std::ptrdiff_t{run.row} * kShadowPx * 2;
        for (int x = run.begin; x < run.end; ++x) {
            std::uint8_t* pixel = row + std::ptrdiff_t{x} * 2;
            pixel[0] = value;
            pixel[1] = std::max(pixel[1], heights.around(x, run.row, kShadowPx));
        }
        shadowed_.add(
            {at(run.begin, run.row).array() - kBlurM, at(run.end, run.row + 1).array() + kBlurM});
    }
}

const gl::ShaderProgram& Backdrop::begin_solid_shadows() {
    gl::upload_pixels(
        shadow_.colour, gl::PixelFormat::kRg8, 0, 0, kShadowPx, kShadowPx, painted_.data());
    glDisable(GL_DEPTH_TEST);
    glDisable(GL_CULL_FACE);
    glEnable(GL_BLEND);
    glBlendEquation(GL_MAX);  // the highest of several
    shadow_.bind();
    return begin(shadow_shader_);
}

// Blurs here because the shadow map has far fewer pixels than the floor in the view.
void Backdrop::end_shadows() {
    glDisable(GL_BLEND);
    glBlendEquation(GL_FUNC_ADD);
    blurred_.bind();
    glClearColor(0.0f, 0.0f, 0.0f, 0.0f);
    glClear(GL_COLOR_BUFFER_BIT);
    if (shadowed_.empty()) return;
    shadowed_.find_triangles(Eigen::Vector2d::Constant(kShadowExtentM), {}, triangles_);
    blur_shader_.use();
    blur_shader_.set("shadow_extent", kShadowExtentM);
    blur_shader_.set("texel", 1.0f / kShadowPx);
    gl::bind_texture(0, shadow_.colour);
    blur_shader_.set("picture", 0);
    draw_triangles();
}

void Backdrop::draw_triangles() const {
    glBindVertexArray(triangles_layout_.id());
    gl::upload(triangles_corners_,
               GL_ARRAY_BUFFER,
               std::span<const Eigen::Vector3f>(triangles_),
               GL_STREAM_DRAW);
    glDrawArrays(GL_TRIANGLES, 0, static_cast<GLsizei>(triangles_.size()));
}

const gl::ShaderProgram& Backdrop::begin_object_shadows() {
    begin(object_shadow_shader_).set("darkness", 1.0f);
    return object_shadow_shader_;
}

void Backdrop::add_shadow_of(const Eigen::AlignedBox3d& box_world) {
    if (box_world.isEmpty()) return;
    const Eigen::Vector3d light = light_world().cast<double>();
    Eigen::AlignedBox2d part;
    for (int i = 0; i < 8; ++i) {
        const Eigen::Vector3d p = box_world.corner(static_cast<Eigen::AlignedBox3d::CornerType>(i));
        part.extend(Eigen::Vector2d(p.head<2>() - light.head<2>() * (p.z() / light.z())));
    }
    shadowed_.add({part.min().array() - kBlurM, part.max().array() + kBlurM});
}

void Backdrop::draw_plane(const View& view,
                          const ObjectLook& look,
                          const Eigen::Vector3f& colour,
                          const Textures& textures) {
    const gl::ShaderProgram& shader = floor_shaders_[textures.bind(look.texture, 1) ? 1 : 0];
    shader.use();
    shader.set("clip_from_world", Eigen::Matrix4f(view.clip_from_world.cast<float>()));
    shader.set("world_from_floor", Eigen::Matrix4f(look.world_from_object.matrix().cast<float>()));
    shader.set("half_size", Eigen::Vector2f((0.5 * look.size_m.head<2>()).cast<float>()));
    shader.set("colour", colour);
    shader.set("horizon", kHorizon);
    shader.set("picture", 1);
    shader.set("fade", kFade);
    square_.draw();
}

namespace {

// Returns the ground below and around the floors.
ObjectLook ground_of(std::span<const ObjectLook* const> floors) {
    constexpr double kBelowM = 0.01;
    ObjectLook ground{.shape = ShapeKind::kPlane};
    ground.size_m = {kGroundSizeM, kGroundSizeM, 0.0};
    double lowest = 0.0;
    for (const ObjectLook* floor : floors)
        lowest = std::min(lowest, floor->world_from_object.translation.z());
    ground.world_from_object.translation.z() = floors.empty() ? 0.0 : lowest - kBelowM;
    return ground;
}

bool covers(const ObjectLook& floor, const Eigen::AlignedBox2d& part_world) {
    const geometry::RigidTransform floor_from_world = floor.world_from_object.inverse();
    for (int i = 0; i < 4; ++i) {
        const Eigen::Vector2d p =
            part_world.corner(static_cast<Eigen::AlignedBox2d::CornerType>(i));
        const Eigen::Vector3d at(p.x(), p.y(), floor.world_from_object.translation.z());
        const Eigen::Array2d in_floor = (floor_from_world * at).head<2>();
        if ((in_floor.abs() > 0.5 * floor.size_m.head<2>().array()).any()) return false;
    }
    return true;
}

}  // namespace

void Backdrop::draw(const EyeView& eye,
                    std::span<const ObjectLook* const> floors,
                    const Textures& textures) {
    const View view = eye.view();
    for (const ObjectLook* floor : floors)
        draw_plane(view, *floor, encode_srgb(floor->colour), textures);
    draw_plane(view, ground_of(floors), kGroundColour, {});
    draw_sky(eye);
}

bool Backdrop::copy(const EyeView& eye,
                    std::span<const ObjectLook* const> floors,
                    const Textures& textures,
                    const gl::Framebuffer& target) {
    const bool is_seen_alike = last_eye_ == eye;
    is_kept_ = is_kept_ && is_seen_alike;
    last_eye_ = eye;
    const bool has_all = eye.part_px == image::PixelRect{0, 0, target.width, target.height} &&
                         eye.writes == std::array{true, true, true};
    if (!is_seen_alike || !has_all) return false;
    if (!is_kept_) {
        if (kept_.width != target.width || kept_.height != target.height) {
            auto made = gl::make_framebuffer(target.width, target.height);
            if (!made) return false;
            kept_ = std::move(*made);
        }
        kept_.bind();
        glClear(GL_DEPTH_BUFFER_BIT);
        draw(eye, floors, textures);
        is_kept_ = true;
    }
    glBindFramebuffer(GL_READ_FRAMEBUFFER, kept_.name.id());
    glBindFramebuffer(GL_DRAW_FRAMEBUFFER, target.name.id());
    const auto [x, y, width, height] = eye.part_px;
    glBlitFramebuffer(x,
                      y,
                      width,
                      height,
                      x,
                      y,
                      width,
                      height,
                      GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT,
                      GL_NEAREST);
    target.bind();
    return true;
}

// Multiplies what is there, at the depth of the surfaces that are drawn once more.
void Backdrop::begin_darkening(const gl::ShaderProgram& shader, const View& view) {
    shader.use();
    shader.set("clip_from_world", Eigen::Matrix4f(view.clip_from_world.cast<float>()));
    gl::bind_texture(0, blurred_.colour);
    shader.set("shadow", 0);
    shader.set("shadow_extent", kShadowExtentM);
    shader.set("shadow_strength", 0.30f);
    // offset towards the eye: rounding makes the depths of surface and shadow differ
    glEnable(GL_POLYGON_OFFSET_FILL);
    glPolygonOffset(0.0f, -4.0f);
    glDepthMask(GL_FALSE);
    glEnable(GL_BLEND);
    glBlendFuncSeparate(GL_ZERO, GL_SRC_COLOR, GL_ZERO, GL_ONE);
}

void Backdrop::end_darkening() {
    glDisable(GL_BLEND);
    glDepthMask(GL_TRUE);
    glDisable(GL_POLYGON_OFFSET_FILL);
}

void Backdrop::draw_shadows(const View& view, std::span<const ObjectLook* const> floors) {
    if (!are_shadows_on_ || shadowed_.empty()) return;
    begin_darkening(floor_shadow_shader_, view);
    floor_shadow_shader_.set("fade", kFade);
    bool is_ground_hidden = false;
    const Eigen::AlignedBox2d bounds = shadowed_.bounds();
    for (const ObjectLook* floor : floors) {
        draw_shadow(*floor);
        const double height_m = floor->world_from_object.translation.z();
        if (view.eye_world.z() > height_m && covers(*floor, bounds)) is_ground_hidden = true;
    }
    if (!is_ground_hidden) draw_shadow(ground_of(floors));
    end_darkening();
}

bool Backdrop::begin_received_shadows(const View& view) {
    if (!are_shadows_on_ || shadowed_.empty()) return false;
    begin_darkening(received_shadow_shader_, view);
    received_shadow_shader_.set("light", light_world());
    received_shadow_shader_.set("most_height", ShadowHeights::kMostM);
    return true;
}

void Backdrop::end_received_shadows() { end_darkening(); }

// The map shows z = 0: a floor at another height lies there, along the light.
void Backdrop::draw_shadow(const ObjectLook& look) {
    constexpr double kSlackM = 0.05;
    const Eigen::Vector3d light = light_world().cast<double>();
    geometry::RigidTransform in_map = look.world_from_object;
    const double height_m = in_map.translation.z();
    const Eigen::Vector3d lift = light * (height_m / light.z());
    in_map.translation -= lift;
    shadowed_.find_triangles(0.5 * look.size_m.head<2>(), in_map, triangles_);
    if (triangles_.empty()) return;
    floor_shadow_shader_.set("lift", Eigen::Vector3f(lift.cast<float>()));
    floor_shadow_shader_.set("lowest",
                             static_cast<float>((height_m - kSlackM) / ShadowHeights::kMostM));
    draw_triangles();
}

void Backdrop::draw_sky(const EyeView& eye) {
    // sine of the elevation along the rays through the corners; nearly linear in between
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
