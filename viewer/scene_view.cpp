#include "viewer/scene_view.hpp"

#include <utility>

namespace atrium::viewer {
namespace {

renderer::ShapeKind shape_kind(bus::Shape shape) {
    switch (shape) {
        case bus::Shape::kSphere:
            return renderer::ShapeKind::kSphere;
        case bus::Shape::kCylinder:
            return renderer::ShapeKind::kCylinder;
        case bus::Shape::kCapsule:
            return renderer::ShapeKind::kCapsule;
        case bus::Shape::kPlane:
            return renderer::ShapeKind::kPlane;
        case bus::Shape::kBox:
        case bus::Shape::kConvex:
        case bus::Shape::kCompound:
        case bus::Shape::kSoft:
            break;
    }
    return renderer::ShapeKind::kBox;
}

constexpr std::size_t kMaxSites = 64;  // as of people

// That are kept, of a world that sends at most 120 a second.
std::size_t states_within(std::chrono::nanoseconds delay) {
    constexpr std::size_t kAround = 8;
    return kAround + static_cast<std::size_t>(120.0 * std::chrono::duration<double>(delay).count());
}

}  // namespace

SceneView::SceneView(const std::filesystem::path& models, std::chrono::nanoseconds delay)
    : models_(models),
      textures_(models),
      timeline_({.max_states = states_within(delay)}),
      soft_timeline_(states_within(delay)) {}

// An object that is soft is drawn once both its descriptions have come, in any order.
void SceneView::show_soft(std::uint32_t object, renderer::SceneRenderer& renderer) {
    const auto body = soft_bodies_.find(object);
    const auto described = objects_.find(object);
    if (body == soft_bodies_.end() || described == objects_.end() ||
        described->second.shape != bus::Shape::kSoft) {
        return renderer.remove_soft_object(object);
    }
    renderer.set_soft_object(object,
                             {.num_nodes = body->second.num_nodes,
                              .triangles = body->second.triangles,
                              .segments = body->second.segments,
                              .thickness_m = body->second.thickness_m,
                              .colour = described->second.colour,
                              .texture = described->second.texture});
}

void SceneView::update_soft(const SceneChanges& changes, renderer::SceneRenderer& renderer) {
    for (const auto& [id, body] : changes.soft_bodies) {
        if (body)
            soft_bodies_.insert_or_assign(id, *body);
        else
            soft_bodies_.erase(id);
        if (!body) soft_timeline_.remove(id);
        nodes_.erase(id);
        show_soft(id, renderer);
    }
}

void SceneView::update(SceneChanges changes,
                       SceneTimeline::Clock::time_point now,
                       const std::optional<Timestamp>& instant,
                       renderer::SceneRenderer& renderer) {
    if (!changes.objects.empty()) ++revision_;
    for (const auto& [id, object] : changes.objects) {
        renderer.remove_object(id);
        if (object)
            objects_.insert_or_assign(id, *object);
        else
            objects_.erase(id);
        if (object && !object->texture.empty()) textures_.want(object->texture);
        if (object && object->shape != bus::Shape::kSoft)
            renderer.set_object(id, models_.look_of(*object, shape_kind(object->shape)));
        show_soft(id, renderer);
    }
    update_soft(changes, renderer);
    for (const auto& [name, scenery] : changes.scenery) {
        if (scenery && !scenery->texture.empty()) textures_.want(scenery->texture);
        renderer.set_scenery(
            name, scenery ? models_.look_of(*scenery) : std::vector<renderer::ObjectLook>{});
    }
    for (const auto& [name, picture] : textures_.take()) renderer.set_texture(name, picture);
    for (auto& [site, description] : changes.sites) {
        if (description == nullptr)
            sites_.erase(site);
        else if (sites_.size() < kMaxSites || sites_.contains(site))
            sites_.insert_or_assign(site, std::move(description));
    }
    for (const auto& [site, placement] : changes.placements)
        renderer.set_site_pose(site, placement.world_from_site);
    for (auto& state : changes.soft_states) soft_timeline_.add(std::move(state));
    for (auto& [state, arrival] : changes.states) timeline_.add(std::move(state), arrival);
    const auto newest = timeline_.shown_time(now);
    if (!newest) return;
    const Timestamp time = instant.value_or(*newest);
    timeline_.sample_at(time, states_);
    for (const bus::ObjectState& state : states_)
        renderer.move_object(state.object, state.world_from_object);
    for (const auto& [id, body] : soft_bodies_) {
        std::vector<Eigen::Vector3f>& nodes = nodes_[id];
        if (soft_timeline_.sample(id, time, nodes)) renderer.move_soft_object(id, nodes);
    }
}

std::optional<Hit> SceneView::pick(const Ray& ray) const {
    std::optional<Hit> nearest;
    const auto consider = [&](const std::optional<Hit>& candidate) {
        if (candidate && (!nearest || candidate->distance_m < nearest->distance_m))
            nearest = candidate;
    };
    for (const bus::ObjectState& state : states_) {
        const auto object = objects_.find(state.object);
        if (object == objects_.end() || object->second.mass_kg == 0.0) continue;
        consider(hit(ray, object->second, state.world_from_object));
    }
    for (const auto& [id, body] : soft_bodies_) {
        const auto nodes = nodes_.find(id);
        if (nodes != nodes_.end()) consider(hit(ray, body, nodes->second));
    }
    return nearest;
}

void SceneView::clear() {
    timeline_.clear();
    soft_timeline_.clear();
    textures_.forget();
    objects_.clear();
    soft_bodies_.clear();
    nodes_.clear();
    states_.clear();
}

}  // namespace atrium::viewer
