#include "viewer/scene/scene_view.hpp"

#include <algorithm>
#include <limits>
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

constexpr auto kTimeForChanges = std::chrono::milliseconds(5);  // per picture
constexpr std::size_t kMaxSites = 64;                           // as many as people

// Number of states to keep from a world that sends at most 120 a second.
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

// Draws a soft object once both its descriptions have arrived, in either order.
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

void SceneView::change(std::uint32_t id,
                       const std::optional<bus::SceneObject>& object,
                       renderer::SceneRenderer& renderer) {
    ++revision_;
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

void SceneView::change(std::uint32_t id,
                       const std::optional<bus::SoftBody>& body,
                       renderer::SceneRenderer& renderer) {
    if (body)
        soft_bodies_.insert_or_assign(id, *body);
    else
        soft_bodies_.erase(id);
    if (!body) soft_timeline_.remove(id);
    nodes_.erase(id);
    show_soft(id, renderer);
}

void SceneView::change(const std::string& name,
                       const std::optional<bus::Scenery>& scenery,
                       renderer::SceneRenderer& renderer) {
    ++revision_;
    if (!scenery) {
        scenery_.erase(name);
        renderer.set_scenery(name, {});
        return;
    }
    if (!scenery->texture.empty()) textures_.want(scenery->texture);
    scenery_.insert_or_assign(name, *scenery);
    renderer.set_scenery(name, models_.look_of(*scenery));
}

// Applies at least one change, then as many as there is time for: thousands of objects must not
// delay the picture.
void SceneView::take_changes(SceneTimeline::Clock::time_point until,
                             renderer::SceneRenderer& renderer) {
    const auto take_from = [&](auto& changes) {
        while (!changes.empty()) {
            const auto next = changes.extract(changes.begin());
            change(next.key(), next.mapped(), renderer);
            if (SceneTimeline::Clock::now() >= until) return false;
        }
        return true;
    };
    if (take_from(waiting_.objects) && take_from(waiting_.soft_bodies)) take_from(waiting_.scenery);
}

// Only of new samples: two objects with different versions of one file, which are shown again
// whenever it is loaded, must not have it read in turns.
void SceneView::expect_files(const SceneChanges& changes) {
    const auto expect = [this](const auto& things) {
        for (const auto& [key, thing] : things) {
            if (!thing) continue;
            models_.expect(thing->model, thing->model_fingerprint);
            textures_.expect(thing->texture, thing->texture_fingerprint);
        }
    };
    expect(changes.objects);
    expect(changes.scenery);
}

// Shows newly loaded textures, and queues the objects whose models were loaded.
void SceneView::show_new_files(SceneTimeline::Clock::time_point now,
                               renderer::SceneRenderer& renderer) {
    for (const auto& [name, picture] : textures_.take(now)) renderer.set_texture(name, picture);
    const std::set<std::string> models = models_.take(now);
    if (models.empty()) return;
    for (const auto& [id, object] : objects_) {
        if (models.contains(object.model)) waiting_.objects.try_emplace(id, object);
    }
    for (const auto& [name, scenery] : scenery_) {
        if (models.contains(scenery.model)) waiting_.scenery.try_emplace(name, scenery);
    }
}

void SceneView::update(SceneChanges changes,
                       SceneTimeline::Clock::time_point now,
                       const std::optional<Timestamp>& instant,
                       renderer::SceneRenderer& renderer) {
    expect_files(changes);
    const auto add = [](auto& waiting, auto& newer) {
        newer.merge(waiting);  // a newer change replaces a waiting one
        waiting.swap(newer);
    };
    add(waiting_.objects, changes.objects);
    add(waiting_.soft_bodies, changes.soft_bodies);
    add(waiting_.scenery, changes.scenery);
    show_new_files(now, renderer);
    take_changes(SceneTimeline::Clock::now() + kTimeForChanges, renderer);
    for (auto& [site, description] : changes.sites) {
        if (description == nullptr)
            sites_.erase(site);
        else if (sites_.size() < kMaxSites || sites_.contains(site))
            sites_.insert_or_assign(site, std::move(description));
    }
    for (const auto& [site, placement] : changes.placements)
        renderer.set_site_pose(site, placement.world_from_site);
    if (changes.is_new_time) timeline_.clear();
    for (const std::uint32_t object : changes.soft_new_times) soft_timeline_.remove(object);
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

std::shared_ptr<const renderer::ShapeMesh> SceneView::mesh_of(
    const bus::SceneObject& object) const {
    return models_.loaded(object.model, object.model_scale);
}

std::optional<Hit> SceneView::pick(const Ray& ray, Pickable which) const {
    std::optional<Hit> nearest;
    const auto consider = [&](const std::optional<Hit>& candidate) {
        if (candidate && (!nearest || candidate->distance_m < nearest->distance_m))
            nearest = candidate;
    };
    for (const bus::ObjectState& state : states_) {
        const auto object = objects_.find(state.object);
        if (object == objects_.end()) continue;
        const bool is_pickable = which == Pickable::kMovable
                                     ? object->second.mass_kg > 0.0
                                     : object->second.shape != bus::Shape::kPlane;
        if (!is_pickable) continue;
        consider(hit_object(ray, object->second, state.world_from_object));
    }
    for (const auto& [id, body] : soft_bodies_) {
        const auto nodes = nodes_.find(id);
        if (nodes != nodes_.end()) consider(hit(ray, body, nodes->second));
    }
    const bool is_hidden = nearest && free_m(ray) < nearest->distance_m;
    return is_hidden ? std::nullopt : nearest;
}

// What is drawn: the origin of a model may be anywhere.
std::optional<Hit> SceneView::hit_object(const Ray& ray,
                                         const bus::SceneObject& object,
                                         const geometry::RigidTransform& world_from_object) const {
    if (const auto mesh = mesh_of(object)) return hit(ray, object.object, *mesh, world_from_object);
    return hit(ray, object, world_from_object);
}

double SceneView::free_m(const Ray& ray) const {
    double free_m = std::numeric_limits<double>::infinity();
    const auto consider = [&](const std::optional<Hit>& found) {
        if (found) free_m = std::min(free_m, found->distance_m);
    };
    for (const bus::ObjectState& state : states_) {
        const auto object = objects_.find(state.object);
        if (object == objects_.end() || object->second.mass_kg > 0.0 ||
            object->second.shape == bus::Shape::kPlane)
            continue;
        consider(hit_object(ray, object->second, state.world_from_object));
    }
    for (const auto& [name, scenery] : scenery_) {
        if (const auto mesh = models_.loaded(scenery.model, scenery.model_scale))
            consider(hit(ray, 0, *mesh, scenery.world_from_model));
    }
    return free_m;
}

std::set<std::string> SceneView::site_names() const {
    std::set<std::string> names;
    for (const auto& [name, site] : sites_) names.insert(name);
    return names;
}

bool SceneView::is_complete() const {
    return waiting_.objects.empty() && waiting_.soft_bodies.empty() && waiting_.scenery.empty() &&
           models_.is_idle() && textures_.is_idle();
}

template <typename IsModel, typename IsTexture>
std::string SceneView::file_that(const IsModel& is_model, const IsTexture& is_texture) const {
    const auto file_of = [&](const auto& thing) -> std::string {
        if (!thing.model.empty() && is_model(thing.model, thing.model_scale))
            return "model " + thing.model;
        return is_texture(thing.texture) ? "texture " + thing.texture : "";
    };
    for (const auto& [id, object] : objects_)
        if (std::string file = file_of(object); !file.empty()) return file;
    for (const auto& [name, scenery] : scenery_)
        if (std::string file = file_of(scenery); !file.empty()) return file;
    return {};
}

BadFiles SceneView::bad_files() const {
    return {file_that(
                [this](const auto& file, double scale) { return models_.is_missing(file, scale); },
                [this](const auto& file) { return textures_.is_missing(file); }),
            file_that([this](const auto& file,
                             double scale) { return models_.is_different(file, scale); },
                      [this](const auto& file) { return textures_.is_different(file); })};
}

void SceneView::clear() {
    timeline_.clear();
    soft_timeline_.clear();
    textures_.forget();
    models_.forget();
    waiting_ = {};
    objects_.clear();
    scenery_.clear();
    soft_bodies_.clear();
    nodes_.clear();
    states_.clear();
}

}  // namespace atrium::viewer
