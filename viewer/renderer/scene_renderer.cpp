#include "viewer/renderer/scene_renderer.hpp"

#include "core/gl/resources.hpp"
#include "core/gl/shader_program.hpp"
#include "viewer/renderer/backdrop.hpp"
#include "viewer/renderer/fxaa.hpp"
#include "viewer/renderer/object/object_batch.hpp"
#include "viewer/renderer/object/object_drawing.hpp"
#include "viewer/renderer/object/object_shaders.hpp"
#include "viewer/renderer/object/textures.hpp"
#include "viewer/renderer/person/person_drawing.hpp"
#include "viewer/renderer/person/silhouette_drawing.hpp"
#include "viewer/renderer/person/warm_up_person.hpp"
#include "viewer/renderer/shaders.hpp"

#include <glad/gl.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <map>
#include <optional>
#include <utility>

namespace atrium::renderer {

// The floor blurs its shadow map over about three pixels.
constexpr double kShadowDetail_px_per_m = Backdrop::kShadowPx / Backdrop::kShadowExtentM / 3.0;
// Scenery that reaches farther from its origin is a room; its roof would darken the whole floor.
constexpr double kRoomRadiusM = 3.5;

struct SceneRenderer::Impl {
    RendererOptions options;
    PersonShaders person_shaders;
    ObjectShaders object_shaders;
    ObjectShaders soft_shaders;
    double scale = 1.0;
    bool has_shadows = true;
    gl::Framebuffer target;    // the scene, at `scale` of the picture's size
    std::optional<Fxaa> fxaa;  // only with anti-aliasing, of the size of `target`
    gl::Framebuffer enlarged;  // the picture if `scale` is not 1
    std::optional<Backdrop> backdrop;
    std::optional<Overlay> overlay;
    std::optional<SilhouetteDrawing> silhouettes;
    Textures textures;
    std::map<std::string, PersonDrawing> people;
    std::map<std::string, Eigen::Matrix4d> site_poses;
    ObjectMeshes meshes;
    ObjectBatch batch;
    std::map<std::uint32_t, ObjectDrawing> objects;
    std::map<std::uint32_t, SoftDrawing> soft_objects;
    std::map<std::string, std::vector<ObjectDrawing>> scenery;
    bool is_shadow_current = false;
    mutable std::vector<std::uint8_t> rows;  // scratch of `read_pixels`, bottom row first

    Expected<void> create_shaders();
    Expected<void> create_targets(int width, int height);
    void draw_shadow();
    void draw_objects(const View& view);
    void add_object(const View& view, const ObjectDrawing& object);
    std::vector<const ObjectLook*> floors() const;
    void floor_changes(std::uint32_t object);  // if the object is a floor
    image::PixelRect scaled(const image::PixelRect& part_px) const;
    void draw_eye(const EyeView& eye, std::span<const ObjectLook* const> floors, bool has_backdrop);
    void begin_eye(const EyeView& eye, const gl::Framebuffer& on) const;
    void enlarge();
    void draw_faded(PersonDrawing& person, const EyeView& eye);
    void present(const image::PixelRect& part_px, unsigned buffer) const;
    // the scene before it is enlarged
    const gl::Framebuffer& drawn() const { return fxaa ? fxaa->picture() : target; }
    const gl::Framebuffer& finished() const { return scale < 1.0 ? enlarged : drawn(); }
};

Expected<void> SceneRenderer::Impl::create_shaders() {
    auto person = PersonShaders::create();
    if (!person) return tl::unexpected(person.error());
    person_shaders = std::move(*person);
    auto object = ObjectShaders::create("object", shaders::kObjectVertex);
    if (!object) return tl::unexpected(object.error());
    object_shaders = std::move(*object);
    auto soft = ObjectShaders::create("soft", shaders::kSoftVertex);
    if (!soft) return tl::unexpected(soft.error());
    soft_shaders = std::move(*soft);
    if (options.antialias == Antialias::kFxaa) {
        auto created = Fxaa::create();
        if (!created) return tl::unexpected(created.error());
        fxaa = std::move(*created);
    }
    auto behind = Backdrop::create();
    if (!behind) return tl::unexpected(behind.error());
    backdrop = std::move(*behind);
    auto over = Overlay::create();
    if (!over) return tl::unexpected(over.error());
    overlay = std::move(*over);
    auto silhouette = SilhouetteDrawing::create();
    if (!silhouette) return tl::unexpected(silhouette.error());
    silhouettes = std::move(*silhouette);
    return {};
}

Expected<void> SceneRenderer::Impl::create_targets(int width, int height) {
    const image::PixelRect part_px = scaled({0, 0, width, height});
    auto framebuffer = gl::make_framebuffer(part_px.width, part_px.height);
    if (!framebuffer) return tl::unexpected(framebuffer.error());
    gl::Framebuffer full;
    if (scale < 1.0) {
        auto made = gl::make_framebuffer(width, height);
        if (!made) return tl::unexpected(made.error());
        full = std::move(*made);
    }
    if (fxaa)
        if (auto ok = fxaa->resize(part_px.width, part_px.height); !ok) return ok;
    target = std::move(*framebuffer);
    enlarged = std::move(full);
    options.width = width;
    options.height = height;
    return {};
}

// Scales a part. Adjacent parts stay adjacent.
image::PixelRect SceneRenderer::Impl::scaled(const image::PixelRect& part_px) const {
    const auto at = [this](int px) { return static_cast<int>(std::lround(scale * px)); };
    image::PixelRect part{at(part_px.x), at(part_px.y), 0, 0};
    part.width = std::max(1, at(part_px.x + part_px.width) - part.x);
    part.height = std::max(1, at(part_px.y + part_px.height) - part.y);
    return part;
}

void SceneRenderer::Impl::draw_shadow() {
    if (is_shadow_current) return;
    is_shadow_current = true;
    backdrop->begin_shadows();
    // faded people first: solid ones overwrite them
    for (const bool is_solid : {false, true}) {
        for (const auto& [site, person] : people) {
            if (person.is_solid() == is_solid && person.opacity() > 0.0)
                backdrop->add_shadow(person.shadow(), person.opacity());
        }
    }
    const gl::ShaderProgram& shader = backdrop->begin_solid_shadows();
    shader.set("darkness", 1.0f);
    shader.set("world_from_object", Eigen::Matrix4f(Eigen::Matrix4f::Identity()));
    for (const auto& [id, soft] : soft_objects) {
        soft.draw();
        backdrop->add_shadow_of(soft.bounds.cast<double>());
    }
    const auto add = [&](const ObjectDrawing& object) {
        batch.add(object, object.radius_m * kShadowDetail_px_per_m);
        const Eigen::Vector3d& middle = object.look.world_from_object.translation;
        backdrop->add_shadow_of(
            {middle.array() - object.radius_m, middle.array() + object.radius_m});
    };
    for (const auto& [id, object] : objects) {
        if (object.look.model == nullptr && object.look.shape == ShapeKind::kPlane) continue;
        add(object);
    }
    for (const auto& [name, parts] : scenery) {
        for (const ObjectDrawing& part : parts) {
            if (part.radius_m < kRoomRadiusM) add(part);
        }
    }
    backdrop->begin_object_shadows();
    batch.draw_shadows();
    backdrop->end_shadows();
}

void SceneRenderer::Impl::add_object(const View& view, const ObjectDrawing& object) {
    const double radius_px =
        seen_radius_px(view, object.look.world_from_object.translation, object.radius_m);
    // objects in a crowd get fewer triangles each, which bounds the cost of a picture
    constexpr double kMany = 300.0;
    const double detail = std::sqrt(kMany / std::max(kMany, static_cast<double>(objects.size())));
    if (radius_px > 0.0) batch.add(object, detail * radius_px);
}

void SceneRenderer::Impl::floor_changes(std::uint32_t object) {
    const auto found = objects.find(object);
    if (found != objects.end() && found->second.is_floor()) backdrop->changed();
}

void SceneRenderer::Impl::draw_objects(const View& view) {
    object_shaders.set_view(view);
    glEnable(GL_CULL_FACE);
    for (const auto& [id, object] : objects) {
        if (object.look.model == nullptr && !object.is_floor()) add_object(view, object);
    }
    batch.draw(object_shaders, textures);
    // draw both sides: models may be open, and cloth has no inside
    glDisable(GL_CULL_FACE);
    for (const auto& [id, object] : objects) {
        if (object.look.model != nullptr) add_object(view, object);
    }
    for (const auto& [name, parts] : scenery) {
        for (const ObjectDrawing& part : parts) add_object(view, part);
    }
    batch.draw(object_shaders, textures);
    if (soft_objects.empty()) return;
    soft_shaders.set_view(view);
    for (const auto& [id, soft] : soft_objects) {
        using shaders::Surface;
        const bool is_textured = textures.bind(soft.look.texture, 0);
        const gl::ShaderProgram& shader =
            soft_shaders.of(is_textured ? Surface::kTextured : Surface::kPlain);
        shader.use();
        shader.set("soft_colour", Eigen::Vector3f(soft.look.colour.cast<float>()));
        soft.draw();
    }
}

std::vector<const ObjectLook*> SceneRenderer::Impl::floors() const {
    std::vector<const ObjectLook*> floors;
    for (const auto& [id, object] : objects)
        if (object.is_floor()) floors.push_back(&object.look);
    return floors;
}

void SceneRenderer::Impl::draw_eye(const EyeView& eye,
                                   std::span<const ObjectLook* const> floors,
                                   bool has_backdrop) {
    const View view = eye.view();
    if (overlay->is_wireframe()) glPolygonMode(GL_FRONT_AND_BACK, GL_LINE);
    for (auto& [site, person] : people) {
        if (person.is_solid()) person.draw(person_shaders, view.clip_from_world, view.eye_world);
    }
    draw_objects(view);
    glPolygonMode(GL_FRONT_AND_BACK, GL_FILL);
    if (!has_backdrop) backdrop->draw(eye, floors, textures);
    backdrop->draw_shadows(view, floors);
    // after everything that is visible through them
    for (auto& [site, person] : people) {
        if (!person.is_solid()) draw_faded(person, eye);
    }
    silhouettes->draw(people, view.clip_from_world, overlay->silhouettes_m());
    overlay->draw_lines(eye);
}

void SceneRenderer::Impl::begin_eye(const EyeView& eye, const gl::Framebuffer& on) const {
    glViewport(eye.part_px.x,
               on.height - eye.part_px.y - eye.part_px.height,
               eye.part_px.width,
               eye.part_px.height);
    glColorMask(eye.writes[0], eye.writes[1], eye.writes[2], GL_TRUE);
}

void SceneRenderer::Impl::enlarge() {
    glBindFramebuffer(GL_READ_FRAMEBUFFER, drawn().name.id());
    glBindFramebuffer(GL_DRAW_FRAMEBUFFER, enlarged.name.id());
    glBlitFramebuffer(0,
                      0,
                      target.width,
                      target.height,
                      0,
                      0,
                      enlarged.width,
                      enlarged.height,
                      GL_COLOR_BUFFER_BIT,
                      GL_LINEAR);
}

void SceneRenderer::Impl::draw_faded(PersonDrawing& person, const EyeView& eye) {
    const View view = eye.view();
    // depth pass first, so an arm does not show the chest behind it
    glColorMask(GL_FALSE, GL_FALSE, GL_FALSE, GL_FALSE);
    person.draw(person_shaders, view.clip_from_world, view.eye_world);
    glColorMask(eye.writes[0], eye.writes[1], eye.writes[2], GL_TRUE);
    glEnable(GL_BLEND);
    glBlendColor(0.0f, 0.0f, 0.0f, static_cast<float>(person.opacity()));
    glBlendFunc(GL_CONSTANT_ALPHA, GL_ONE_MINUS_CONSTANT_ALPHA);
    person.draw(person_shaders, view.clip_from_world, view.eye_world);
    glDisable(GL_BLEND);
}

SceneRenderer::SceneRenderer(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
SceneRenderer::SceneRenderer(SceneRenderer&&) noexcept = default;
SceneRenderer& SceneRenderer::operator=(SceneRenderer&&) noexcept = default;
SceneRenderer::~SceneRenderer() = default;

Expected<SceneRenderer> SceneRenderer::create(const RendererOptions& options) {
    auto impl = std::make_unique<Impl>();
    impl->options = options;
    if (auto ok = impl->create_shaders(); !ok) return tl::unexpected(ok.error());
    if (auto ok = impl->create_targets(options.width, options.height); !ok)
        return tl::unexpected(ok.error());
    return SceneRenderer(std::move(impl));
}

void SceneRenderer::warm_up(const ViewCamera& camera) {
    assert(num_objects() == 0 && num_people() == 0);
    const std::string painted = "warm_up";
    set_texture(painted, {.width = 2, .height = 2, .rgba = std::vector<std::uint8_t>(16, 255)});
    std::uint32_t num = 0;
    for (const std::string& texture : {std::string(), painted}) {
        for (const ShapeKind shape : {ShapeKind::kBox, ShapeKind::kSphere, ShapeKind::kPlane})
            set_object(num++,
                       {.shape = shape,
                        .texture = texture,
                        .world_from_object = {Eigen::Quaterniond::Identity(), camera.target_m}});
    }
    const double scale = impl_->scale;
    // a driver may treat texture arrays with a power of two of layers differently
    for (const std::size_t num_cameras : {6U, 8U}) {
        set_person(
            painted,
            make_warm_up_person(
                camera.position_m.cast<float>(), camera.target_m.cast<float>(), num_cameras));
        for (const double less : {0.5 * scale, scale}) {
            static_cast<void>(set_scale(less));
            draw(camera);
            draw(camera);  // the second draw uses Backdrop::copy
        }
    }
    glFinish();
    while (num > 0) remove_object(--num);
    remove_person(painted);
    impl_->textures.remove(painted);
}

PersonModel SceneRenderer::set_person(const std::string& site, PersonModel model) {
    impl_->is_shadow_current = false;
    const auto [found, is_new] = impl_->people.try_emplace(site);
    if (is_new) {
        const auto pose = impl_->site_poses.find(site);
        if (pose != impl_->site_poses.end()) found->second.set_pose(pose->second);
    }
    return found->second.set_model(std::move(model));
}

void SceneRenderer::set_site_pose(const std::string& site,
                                  const geometry::RigidTransform& world_from_site) {
    impl_->is_shadow_current = false;
    impl_->site_poses[site] = world_from_site.matrix();
    const auto found = impl_->people.find(site);
    if (found != impl_->people.end()) found->second.set_pose(world_from_site.matrix());
}

Eigen::Matrix4d SceneRenderer::world_from_site(const std::string& site) const {
    const auto found = impl_->site_poses.find(site);
    return found == impl_->site_poses.end() ? Eigen::Matrix4d::Identity() : found->second;
}

void SceneRenderer::set_person_opacity(const std::string& site, double opacity) {
    const auto found = impl_->people.find(site);
    if (found == impl_->people.end() || found->second.opacity() == opacity) return;
    impl_->is_shadow_current = false;
    found->second.set_opacity(opacity);
}

void SceneRenderer::remove_person(const std::string& site) {
    impl_->is_shadow_current = false;
    impl_->people.erase(site);
}

std::size_t SceneRenderer::num_people() const { return impl_->people.size(); }

void SceneRenderer::set_object(std::uint32_t object, const ObjectLook& look) {
    impl_->is_shadow_current = false;
    impl_->floor_changes(object);
    impl_->objects.insert_or_assign(object, ObjectDrawing(look, impl_->meshes));
    impl_->floor_changes(object);
}

void SceneRenderer::move_object(std::uint32_t object,
                                const geometry::RigidTransform& world_from_object) {
    const auto found = impl_->objects.find(object);
    if (found == impl_->objects.end()) return;
    geometry::RigidTransform& pose = found->second.look.world_from_object;
    if (pose.translation == world_from_object.translation &&
        pose.rotation.coeffs() == world_from_object.rotation.coeffs())
        return;
    impl_->floor_changes(object);
    pose = world_from_object;
    impl_->floor_changes(object);
    impl_->is_shadow_current = false;
}

void SceneRenderer::remove_object(std::uint32_t object) {
    impl_->is_shadow_current = false;
    impl_->floor_changes(object);
    impl_->objects.erase(object);
}

std::size_t SceneRenderer::num_objects() const {
    return impl_->objects.size() + impl_->soft_objects.size();
}

void SceneRenderer::set_soft_object(std::uint32_t object, const SoftLook& look) {
    impl_->is_shadow_current = false;
    impl_->soft_objects.insert_or_assign(object, SoftDrawing(look));
}

void SceneRenderer::move_soft_object(std::uint32_t object,
                                     std::span<const Eigen::Vector3f> nodes_world) {
    const auto found = impl_->soft_objects.find(object);
    if (found == impl_->soft_objects.end()) return;
    if (found->second.look.num_nodes != nodes_world.size()) return;
    found->second.move(nodes_world);
    impl_->is_shadow_current = false;
}

void SceneRenderer::remove_soft_object(std::uint32_t object) {
    impl_->is_shadow_current = false;
    impl_->soft_objects.erase(object);
}

void SceneRenderer::set_scenery(const std::string& name, std::span<const ObjectLook> parts) {
    impl_->is_shadow_current = false;
    std::vector<ObjectDrawing>& drawings = impl_->scenery[name];
    drawings.clear();
    for (const ObjectLook& part : parts) drawings.emplace_back(part, impl_->meshes);
    if (drawings.empty()) impl_->scenery.erase(name);
}

void SceneRenderer::set_texture(const std::string& name, const TexturePicture& picture) {
    impl_->textures.set(name, picture);
    impl_->backdrop->changed();
}

Expected<void> SceneRenderer::resize(int width, int height) {
    if (width == impl_->options.width && height == impl_->options.height) return {};
    return impl_->create_targets(width, height);
}

Expected<void> SceneRenderer::set_scale(double scale) {
    assert(scale > 0.0 && scale <= 1.0);
    if (scale == impl_->scale) return {};
    const double before = std::exchange(impl_->scale, scale);
    auto made = impl_->create_targets(impl_->options.width, impl_->options.height);
    if (!made) impl_->scale = before;
    return made;
}

double SceneRenderer::scale() const { return impl_->scale; }

void SceneRenderer::set_shadows(bool are_on) {
    impl_->has_shadows = are_on;
    impl_->backdrop->set_shadows(are_on);
}

bool SceneRenderer::has_shadows() const { return impl_->has_shadows; }

Overlay& SceneRenderer::overlay() { return *impl_->overlay; }

int SceneRenderer::width() const { return impl_->options.width; }
int SceneRenderer::height() const { return impl_->options.height; }

void SceneRenderer::draw(const ViewCamera& camera) {
    const EyeView eye = eye_of(camera, impl_->options.width, impl_->options.height);
    draw({&eye, 1});
}

void SceneRenderer::draw(std::span<const EyeView> eyes) {
    Impl& impl = *impl_;
    if (impl.has_shadows) impl.draw_shadow();
    impl.target.bind();
    // the backdrop covers all other pixels, so colour needs no clearing
    glEnable(GL_DEPTH_TEST);
    glDepthFunc(GL_LEQUAL);
    glDisable(GL_BLEND);
    glDisable(GL_SCISSOR_TEST);
    const std::vector<const ObjectLook*> floors = impl.floors();
    for (const EyeView& eye : eyes) {
        EyeView scaled = eye;
        scaled.part_px = impl.scaled(eye.part_px);
        const bool has_backdrop =
            eyes.size() == 1 && impl.backdrop->copy(scaled, floors, impl.textures, impl.target);
        // drop the depths of another eye in the same part
        if (!has_backdrop) glClear(GL_DEPTH_BUFFER_BIT);
        impl.begin_eye(scaled, impl.target);
        impl.draw_eye(scaled, floors, has_backdrop);
    }
    glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
    if (impl.fxaa) impl.fxaa->draw(impl.target);
    if (impl.scale < 1.0) impl.enlarge();
    impl.finished().bind();
    for (const EyeView& eye : eyes) {
        impl.begin_eye(eye, impl.finished());
        impl.overlay->draw_labels(eye);
    }
    glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
    glBindVertexArray(0);
}

void SceneRenderer::Impl::present(const image::PixelRect& part_px, unsigned buffer) const {
    const gl::Framebuffer& from = finished();
    glBindFramebuffer(GL_READ_FRAMEBUFFER, from.name.id());
    glBindFramebuffer(GL_DRAW_FRAMEBUFFER, 0);
    if (buffer != 0) glDrawBuffer(buffer);
    glBlitFramebuffer(part_px.x,
                      part_px.y,
                      part_px.x + part_px.width,
                      part_px.y + part_px.height,
                      0,
                      0,
                      part_px.width,
                      part_px.height,
                      GL_COLOR_BUFFER_BIT,
                      GL_NEAREST);
    glBindFramebuffer(GL_FRAMEBUFFER, 0);
    glViewport(0, 0, part_px.width, part_px.height);
}

void SceneRenderer::present() const { impl_->present({0, 0, width(), height()}, 0); }

void SceneRenderer::present_halves() const {
    const int half = width() / 2;
    impl_->present({0, 0, half, height()}, GL_BACK_LEFT);
    impl_->present({half, 0, half, height()}, GL_BACK_RIGHT);
    glDrawBuffer(GL_BACK);  // both
}

void SceneRenderer::read_pixels(RenderedPicture& out) const {
    const gl::Framebuffer& from = impl_->finished();
    const std::size_t stride = static_cast<std::size_t>(from.width) * 4;
    const auto height = static_cast<std::size_t>(from.height);
    impl_->rows.resize(stride * height);
    out.rgba.resize(stride * height);
    out.width = from.width;
    out.height = from.height;
    from.bind();
    gl::read_rgba(from.width, from.height, impl_->rows);
    for (std::size_t y = 0; y < height; ++y) {
        std::copy_n(
            impl_->rows.data() + (height - 1 - y) * stride, stride, out.rgba.data() + y * stride);
    }
}

}  // namespace atrium::renderer
