#include "viewer/renderer/object/object_scene.hpp"

#include "core/gl/shader_program.hpp"
#include "viewer/renderer/drawing/shaders.hpp"

#include <glad/gl.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace atrium::renderer {

// The floor blurs its shadow map over about three pixels.
constexpr double kShadowDetail_px_per_m = Backdrop::kShadowPx / Backdrop::kShadowExtentM / 3.0;
// Scenery that reaches farther from its origin is a room; its roof would darken the whole floor.
constexpr double kRoomRadiusM = 3.5;
// Smaller things get no shadow: nobody would see it, and each of them is drawn once more for it.
constexpr double kReceivesM = 0.3;

Expected<ObjectScene> ObjectScene::create() {
    ObjectScene made;
    auto rigid = ObjectShaders::create("object", shaders::kObjectVertex);
    if (!rigid) return tl::unexpected(rigid.error());
    made.shaders_ = std::move(*rigid);
    auto soft = ObjectShaders::create("soft", shaders::kSoftVertex);
    if (!soft) return tl::unexpected(soft.error());
    made.soft_shaders_ = std::move(*soft);
    return made;
}

ObjectScene::Affects ObjectScene::affected_by(std::uint32_t object) const {
    const auto found = objects_.find(object);
    return found != objects_.end() && found->second.is_floor() ? Affects::kFloor
                                                               : Affects::kShadows;
}

ObjectScene::Affects ObjectScene::set(std::uint32_t object, const ObjectLook& look) {
    const Affects before = affected_by(object);
    objects_.insert_or_assign(object, ObjectDrawing(look, meshes_));
    return std::max(before, affected_by(object));
}

ObjectScene::Affects ObjectScene::move(std::uint32_t object,
                                       const geometry::RigidTransform& world_from_object) {
    const auto found = objects_.find(object);
    if (found == objects_.end()) return Affects::kNothing;
    geometry::RigidTransform& pose = found->second.look.world_from_object;
    if (pose.translation == world_from_object.translation &&
        pose.rotation.coeffs() == world_from_object.rotation.coeffs())
        return Affects::kNothing;
    const Affects before = affected_by(object);
    pose = world_from_object;
    return std::max(before, affected_by(object));
}

ObjectScene::Affects ObjectScene::remove(std::uint32_t object) {
    const Affects before = affected_by(object);
    objects_.erase(object);
    return before;
}

ObjectScene::Affects ObjectScene::move_soft(std::uint32_t object,
                                            std::span<const Eigen::Vector3f> nodes_world) {
    const auto found = soft_objects_.find(object);
    if (found == soft_objects_.end()) return Affects::kNothing;
    if (found->second.look.num_nodes != nodes_world.size()) return Affects::kNothing;
    found->second.move(nodes_world);
    return Affects::kShadows;
}

void ObjectScene::set_soft(std::uint32_t object, const SoftLook& look) {
    soft_objects_.insert_or_assign(object, SoftDrawing(look));
}

void ObjectScene::set_scenery(const std::string& name, std::span<const ObjectLook> parts) {
    std::vector<ObjectDrawing>& drawings = scenery_[name];
    drawings.clear();
    for (const ObjectLook& part : parts) drawings.emplace_back(part, meshes_);
    if (drawings.empty()) scenery_.erase(name);
}

std::vector<const ObjectLook*> ObjectScene::floors() const {
    std::vector<const ObjectLook*> floors;
    for (const auto& [id, object] : objects_)
        if (object.is_floor()) floors.push_back(&object.look);
    return floors;
}

void ObjectScene::add_to_batch(const View& view, const ObjectDrawing& object) {
    const double radius_px =
        seen_radius_px(view, object.look.world_from_object.translation, object.radius_m);
    // objects in a crowd get fewer triangles each, which bounds the cost of a picture
    constexpr double kMany = 300.0;
    const double detail = std::sqrt(kMany / std::max(kMany, static_cast<double>(objects_.size())));
    if (radius_px > 0.0) batch_.add(object, detail * radius_px);
}

void ObjectScene::draw(const View& view) {
    shaders_.set_view(view);
    glEnable(GL_CULL_FACE);
    for (const auto& [id, object] : objects_) {
        if (object.look.model == nullptr && !object.is_floor()) add_to_batch(view, object);
    }
    batch_.draw(shaders_, textures_);
    // draw both sides: models may be open, and cloth has no inside
    glDisable(GL_CULL_FACE);
    for (const auto& [id, object] : objects_) {
        if (object.look.model != nullptr) add_to_batch(view, object);
    }
    for (const auto& [name, parts] : scenery_) {
        for (const ObjectDrawing& part : parts) add_to_batch(view, part);
    }
    batch_.draw(shaders_, textures_);
    if (!soft_objects_.empty()) draw_soft(view);
}

void ObjectScene::draw_soft(const View& view) const {
    using shaders::Surface;
    soft_shaders_.set_view(view);
    for (const auto& [id, soft] : soft_objects_) {
        const bool is_textured = textures_.bind(soft.look.texture, 0);
        const gl::ShaderProgram& shader =
            soft_shaders_.of(is_textured ? Surface::kTextured : Surface::kPlain);
        shader.use();
        shader.set("soft_colour", Eigen::Vector3f(soft.look.colour.cast<float>()));
        soft.draw();
    }
}

void ObjectScene::draw_shadows(Backdrop& backdrop) {
    const gl::ShaderProgram& shader = backdrop.begin_solid_shadows();
    shader.set("darkness", 1.0f);
    shader.set("world_from_object", Eigen::Matrix4f(Eigen::Matrix4f::Identity()));
    for (const auto& [id, soft] : soft_objects_) {
        soft.draw();
        backdrop.add_shadow_of(soft.bounds.cast<double>());
    }
    const auto add = [&](const ObjectDrawing& object) {
        batch_.add(object, object.radius_m * kShadowDetail_px_per_m);
        const Eigen::Vector3d& middle = object.look.world_from_object.translation;
        backdrop.add_shadow_of(
            {middle.array() - object.radius_m, middle.array() + object.radius_m});
    };
    for (const auto& [id, object] : objects_) {
        if (object.look.model == nullptr && object.look.shape == ShapeKind::kPlane) continue;
        add(object);
    }
    for (const auto& [name, parts] : scenery_) {
        for (const ObjectDrawing& part : parts) {
            if (part.radius_m < kRoomRadiusM) add(part);
        }
    }
    backdrop.begin_object_shadows();
    batch_.draw_with_bound();
}

void ObjectScene::draw_received_shadows(const View& view, Backdrop& backdrop) {
    if (!backdrop.begin_received_shadows(view)) return;
    const auto add = [&](const ObjectDrawing& object) {
        if (object.radius_m >= kReceivesM) add_to_batch(view, object);
    };
    for (const auto& [id, object] : objects_) {
        const bool is_ball =
            object.look.model == nullptr && object.look.shape == ShapeKind::kSphere;
        if (!object.is_floor() && !is_ball) add(object);
    }
    for (const auto& [name, parts] : scenery_)
        for (const ObjectDrawing& part : parts) add(part);
    batch_.draw_with_bound();
    backdrop.end_received_shadows();
}

}  // namespace atrium::renderer
