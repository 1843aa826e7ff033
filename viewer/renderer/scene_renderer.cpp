#include "viewer/renderer/scene_renderer.hpp"

#include "viewer/renderer/backdrop/backdrop.hpp"
#include "viewer/renderer/object/object_scene.hpp"
#include "viewer/renderer/person/person_drawing.hpp"
#include "viewer/renderer/person/silhouette_drawing.hpp"
#include "viewer/renderer/person/warm_up_person.hpp"
#include "viewer/renderer/picture_target.hpp"

#include <glad/gl.h>

#include <cassert>
#include <map>
#include <optional>
#include <utility>

namespace atrium::renderer {

struct SceneRenderer::Impl {
    PersonShaders person_shaders;
    std::optional<PictureTarget> target;
    std::optional<Backdrop> backdrop;
    std::optional<Overlay> overlay;
    std::optional<SilhouetteDrawing> silhouettes;
    std::optional<ObjectScene> objects;
    std::map<std::string, PersonDrawing> people;
    std::map<std::string, Eigen::Matrix4d> site_poses;
    bool has_shadows = true;
    bool has_soft_outlines = true;
    bool is_shadow_current = false;

    Expected<void> create(const RendererOptions& options);
    void changed(ObjectScene::Affects affected);
    void draw_shadow();
    void draw_eye(const EyeView& eye, std::span<const ObjectLook* const> floors, bool has_backdrop);
    void draw_outline(PersonDrawing& person, const EyeView& eye);
    void draw_faded(PersonDrawing& person, const EyeView& eye);
};

Expected<void> SceneRenderer::Impl::create(const RendererOptions& options) {
    const auto make = [](auto& part, auto made) -> Expected<void> {
        if (!made) return tl::unexpected(made.error());
        part = std::move(*made);
        return {};
    };
    has_soft_outlines = options.has_soft_outlines;
    Expected<void> done = make(person_shaders, PersonShaders::create());
    if (done) done = make(objects, ObjectScene::create());
    if (done) done = make(backdrop, Backdrop::create());
    if (done) done = make(overlay, Overlay::create());
    if (done) done = make(silhouettes, SilhouetteDrawing::create());
    if (done)
        done =
            make(target, PictureTarget::create(options.width, options.height, options.antialias));
    return done;
}

void SceneRenderer::Impl::changed(ObjectScene::Affects affected) {
    using Affects = ObjectScene::Affects;
    if (affected != Affects::kNothing) is_shadow_current = false;
    if (affected == Affects::kFloor) backdrop->changed();
}

void SceneRenderer::Impl::draw_shadow() {
    if (is_shadow_current) return;
    is_shadow_current = true;
    backdrop->begin_shadows();
    // faded people first: solid ones overwrite them
    for (const bool is_solid : {false, true}) {
        for (const auto& [site, person] : people) {
            if (person.is_solid() == is_solid && person.opacity() > 0.0)
                backdrop->add_shadow(person.shadow(), person.shadow_heights(), person.opacity());
        }
    }
    objects->draw_shadows(*backdrop);
    backdrop->end_shadows();
}

void SceneRenderer::Impl::draw_eye(const EyeView& eye,
                                   std::span<const ObjectLook* const> floors,
                                   bool has_backdrop) {
    const View view = eye.view();
    set_line_width(eye);
    if (overlay->is_wireframe()) glPolygonMode(GL_FRONT_AND_BACK, GL_LINE);
    for (auto& [site, person] : people) {
        if (person.is_solid()) person.draw(person_shaders, view.clip_from_world, view.eye_world);
    }
    objects->draw(view);
    glPolygonMode(GL_FRONT_AND_BACK, GL_FILL);
    if (!has_backdrop) backdrop->draw(eye, floors, objects->textures());
    backdrop->draw_shadows(view, floors);
    // one looks through wires at insides, which would be dark
    if (!overlay->is_wireframe()) objects->draw_received_shadows(view, *backdrop);
    // after everything that is visible through them
    for (auto& [site, person] : people)
        if (person.is_solid()) draw_outline(person, eye);
    for (auto& [site, person] : people) {
        if (!person.is_solid() && person.opacity() > 0.0) draw_faded(person, eye);
    }
    silhouettes->draw(people, view.clip_from_world, overlay->silhouettes_m());
    overlay->draw_lines(eye);
}

void SceneRenderer::Impl::draw_outline(PersonDrawing& person, const EyeView& eye) {
    if (!has_soft_outlines || overlay->is_wireframe()) return;
    const View view = eye.view();
    person.draw_outline(person_shaders, view.clip_from_world, view.eye_world, eye.part_px.height);
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
    draw_outline(person, eye);
}

SceneRenderer::SceneRenderer(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
SceneRenderer::SceneRenderer(SceneRenderer&&) noexcept = default;
SceneRenderer& SceneRenderer::operator=(SceneRenderer&&) noexcept = default;
SceneRenderer::~SceneRenderer() = default;

Expected<SceneRenderer> SceneRenderer::create(const RendererOptions& options) {
    auto impl = std::make_unique<Impl>();
    if (auto created = impl->create(options); !created) return tl::unexpected(created.error());
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
    const double scale = impl_->target->scale();
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
    impl_->objects->textures().remove(painted);
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
    impl_->changed(impl_->objects->set(object, look));
}

void SceneRenderer::move_object(std::uint32_t object,
                                const geometry::RigidTransform& world_from_object) {
    impl_->changed(impl_->objects->move(object, world_from_object));
}

void SceneRenderer::remove_object(std::uint32_t object) {
    impl_->changed(impl_->objects->remove(object));
}

std::size_t SceneRenderer::num_objects() const { return impl_->objects->size(); }

void SceneRenderer::set_soft_object(std::uint32_t object, const SoftLook& look) {
    impl_->is_shadow_current = false;
    impl_->objects->set_soft(object, look);
}

void SceneRenderer::move_soft_object(std::uint32_t object,
                                     std::span<const Eigen::Vector3f> nodes_world) {
    impl_->changed(impl_->objects->move_soft(object, nodes_world));
}

void SceneRenderer::remove_soft_object(std::uint32_t object) {
    impl_->is_shadow_current = false;
    impl_->objects->remove_soft(object);
}

void SceneRenderer::set_scenery(const std::string& name, std::span<const ObjectLook> parts) {
    impl_->is_shadow_current = false;
    impl_->objects->set_scenery(name, parts);
}

void SceneRenderer::set_texture(const std::string& name, const TexturePicture& picture) {
    impl_->objects->textures().set(name, picture);
    impl_->backdrop->changed();
}

Expected<void> SceneRenderer::resize(int width, int height) {
    if (width == this->width() && height == this->height()) return {};
    return impl_->target->resize(width, height);
}

Expected<void> SceneRenderer::set_scale(double scale) { return impl_->target->set_scale(scale); }
double SceneRenderer::scale() const { return impl_->target->scale(); }

void SceneRenderer::set_shadows(bool are_on) {
    impl_->has_shadows = are_on;
    impl_->backdrop->set_shadows(are_on);
}

bool SceneRenderer::has_shadows() const { return impl_->has_shadows; }

Overlay& SceneRenderer::overlay() { return *impl_->overlay; }

int SceneRenderer::width() const { return impl_->target->width(); }
int SceneRenderer::height() const { return impl_->target->height(); }

void SceneRenderer::draw(const ViewCamera& camera) {
    const EyeView eye = eye_of(camera, width(), height());
    draw({&eye, 1});
}

void SceneRenderer::draw(std::span<const EyeView> eyes) {
    Impl& impl = *impl_;
    PictureTarget& target = *impl.target;
    if (impl.has_shadows) impl.draw_shadow();
    target.scene().bind();
    // the backdrop covers all other pixels, so colour needs no clearing
    glEnable(GL_DEPTH_TEST);
    glDepthFunc(GL_LEQUAL);
    glDisable(GL_BLEND);
    glDisable(GL_SCISSOR_TEST);
    const std::vector<const ObjectLook*> floors = impl.objects->floors();
    for (const EyeView& eye : eyes) {
        EyeView scaled = eye;
        scaled.part_px = target.scaled(eye.part_px);
        const bool has_backdrop =
            eyes.size() == 1 &&
            impl.backdrop->copy(scaled, floors, impl.objects->textures(), target.scene());
        // drop the depths of another eye in the same part
        if (!has_backdrop) glClear(GL_DEPTH_BUFFER_BIT);
        PictureTarget::begin_eye(scaled, target.scene());
        impl.draw_eye(scaled, floors, has_backdrop);
    }
    glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
    target.finish();
    for (const EyeView& eye : eyes) {
        PictureTarget::begin_eye(eye, target.picture());
        impl.overlay->draw_triangles(eye);
        impl.overlay->draw_labels(eye);
    }
    glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
    glBindVertexArray(0);
}

void SceneRenderer::present() const { impl_->target->present({0, 0, width(), height()}, 0); }

void SceneRenderer::present_halves() const {
    const int half = width() / 2;
    impl_->target->present({0, 0, half, height()}, GL_BACK_LEFT);
    impl_->target->present({half, 0, half, height()}, GL_BACK_RIGHT);
    glDrawBuffer(GL_BACK);  // both
}

void SceneRenderer::read_pixels(RenderedPicture& out) const { impl_->target->read_pixels(out); }

}  // namespace atrium::renderer
