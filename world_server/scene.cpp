#include "world_server/scene.hpp"

#include "core/base/fnv1a.hpp"
#include "core/bus/checks.hpp"
#include "core/bus/soft_nodes.hpp"
#include "core/geometry/aabb.hpp"
#include "world_server/description/texture_fingerprints.hpp"
#include "world_server/proxies.hpp"
#include "world_server/scene_messages.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <set>
#include <utility>

namespace atrium::world_server {
namespace {

constexpr double kLeastExtentM = 0.001;  // smallest extent, across a flat cloth

tl::unexpected<Error> refuse(std::string why) {
    return make_error(ErrorKind::kInvalidData, std::move(why));
}

}  // namespace

Scene::Scene(const physics::WorldOptions& options)
    : options_(options), world_(std::make_unique<physics::World>(options)) {}

Expected<Scene> Scene::create(const WorldServerConfig& config) {
    physics::WorldOptions options = config.world;
    options.tick_s = 1.0 / config.tick_hz;
    options.max_objects = static_cast<std::size_t>(config.max_objects);
    Scene scene(options);
    for (const WorldObject& object : config.objects) {
        if (scene.world_->add(to_rigid(object)) != physics::AddResult::kAdded) {
            return make_error(
                ErrorKind::kConfiguration,
                fmt::format("object '{}': cannot be added: id {} is in use, or a number is "
                            "out of range",
                            object.name,
                            object.rigid.id));
        }
        scene.objects_[object.rigid.id] = to_message(object);
        if (object.rigid.parts) scene.parts_[object.rigid.id] = object.rigid.parts;
    }
    for (const physics::Joint& joint : config.joints) {
        if (!scene.world_->add_joint(joint)) {
            return make_error(
                ErrorKind::kConfiguration,
                fmt::format("joint of objects {} and {}: cannot be created", joint.a, joint.b));
        }
    }
    for (const WorldScenery& scenery : config.scenery) {
        if (scenery.is_solid && !scene.world_->add_static({.mesh = scenery.mesh,
                                                           .friction = scenery.friction,
                                                           .restitution = scenery.restitution})) {
            return make_error(ErrorKind::kConfiguration,
                              fmt::format("scenery '{}': cannot be solid", scenery.name));
        }
    }
    for (const WorldSoftObject& soft : config.soft) {
        if (const auto added = scene.add_soft(soft); !added) return tl::unexpected(added.error());
    }
    scene.world_description_ = std::make_shared<const WorldDescription>(config);
    scene.loaded_ = config.loaded;
    scene.world_file_hash_ = config.world_file_hash;
    scene.num_described_ = static_cast<std::uint32_t>(config.objects.size() + config.soft.size());
    scene.description_ = scene.hash_description();
    return scene;
}

Expected<void> Scene::add_soft(const WorldSoftObject& soft) {
    const physics::SoftObject& described = soft.object;
    if (world_->add_soft(described) != physics::AddResult::kAdded) {
        return make_error(ErrorKind::kConfiguration,
                          fmt::format("soft object '{}': cannot be added: all soft objects "
                                      "together have more than {} nodes",
                                      soft.name,
                                      physics::kMaxSoftNodesTotal));
    }
    world_->get_soft_nodes(described.id, nodes_);
    geometry::Aabb extent;
    for (const Eigen::Vector3f& node : nodes_) extent.add(node.cast<double>());
    objects_[described.id] = to_message(soft, extent.size().cwiseMax(kLeastExtentM));
    return {};
}

// Hashes the part of the description that a state depends on. Colours, for example, may change.
std::uint64_t Scene::hash_description() const {
    std::string text = fmt::format("{} {} {} {} {}",
                                   world_->num_joints(),
                                   options_.tick_s,
                                   options_.gravity.x(),
                                   options_.gravity.y(),
                                   options_.gravity.z());
    for (const auto& [id, object] : objects_) {
        text += fmt::format("; {} {} {} {} {} {} {} {} {}",
                            id,
                            object.name,
                            static_cast<int>(object.shape),
                            object.size_m.x(),
                            object.size_m.y(),
                            object.size_m.z(),
                            object.mass_kg,
                            object.model,
                            object.model_scale);
    }
    return fnv1a<char>(text);
}

void Scene::save(SavedWorld& saved) {
    saved.description = description_;
    saved.next_id = next_id_;
    saved.added.clear();
    saved.edited.clear();
    saved.loaded = loaded_;
    saved.world_file = world_file_hash_;
    for (const auto& [id, object] : objects_) {
        if (id > num_described_)
            saved.added.push_back(object);
        else if (edited_.contains(id))
            saved.edited.push_back(object);
    }
    world_->get_state(saved.state);
    [[maybe_unused]] const bool is_kept = world_->set_state(saved.state);
    assert(is_kept);
}

Expected<Scene> Scene::restore(const WorldServerConfig& config, const SavedWorld& saved) {
    auto scene = create(config);
    if (!scene) return scene;
    if (saved.description != scene->description_) {
        return refuse("world state: belongs to another description of the world");
    }
    std::set<std::uint32_t> kept;
    for (const auto& motion : saved.state.objects) kept.insert(motion.id);
    for (const auto& motion : saved.state.soft) kept.insert(motion.id);
    for (const bus::SceneObject& object : scene->objects()) {
        if (kept.contains(object.object)) continue;
        scene->world_->remove(object.object);
        scene->objects_.erase(object.object);
    }
    for (bus::SceneObject object : saved.added) {
        if (object.object <= scene->num_described_) {
            return refuse("world state: an added object has the id of a described one");
        }
        ModelParts parts;
        if (!object.model.empty()) {
            auto loaded = load_model_parts(config.models_folder / object.model,
                                           object.model_scale,
                                           static_cast<physics::ObjectShape>(object.shape));
            if (!loaded) return tl::unexpected(loaded.error());
            parts = std::move(loaded->parts);
            object.model_fingerprint = loaded->fingerprint;
        }
        object.texture_fingerprint = texture_fingerprint(config.models_folder, object.texture);
        if (const auto added = scene->put(object, parts); !added)
            return tl::unexpected(added.error());
    }
    for (const bus::SceneObject& object : saved.edited) {
        if (auto edited = scene->restore_edited(object); !edited)
            return tl::unexpected(edited.error());
    }
    scene->next_id_ = std::max(scene->next_id_, saved.next_id);
    if (!scene->world_->set_state(saved.state)) {
        return refuse("world state: names an object that is not in the world");
    }
    return scene;
}

Expected<std::vector<SceneChange>> Scene::apply(const bus::SceneCommand& command) {
    switch (command.kind) {
        case bus::CommandKind::kAdd:
            return add(command.object);
        case bus::CommandKind::kRemove:
            return remove_for(command);
        case bus::CommandKind::kPush:
            return push(command);
        case bus::CommandKind::kReset:
            world_->reset();
            return std::vector<SceneChange>{};
        case bus::CommandKind::kGrab:
        case bus::CommandKind::kMove:
        case bus::CommandKind::kRelease:
            return hold(command);
        case bus::CommandKind::kSave:
        case bus::CommandKind::kRestore:
            break;
    }
    return refuse("unknown kind of command");
}

std::string Scene::name_of(std::uint32_t id) const {
    const auto found = objects_.find(id);
    return found == objects_.end() ? std::string() : found->second.name;
}

std::vector<bus::SceneObject> Scene::objects() const {
    std::vector<bus::SceneObject> objects;
    objects.reserve(objects_.size());
    for (const auto& [id, object] : objects_) objects.push_back(object);
    return objects;
}

std::vector<SceneChange> Scene::all() const {
    std::vector<SceneChange> changes;
    changes.reserve(objects_.size());
    for (const auto& [id, object] : objects_) changes.push_back(described(object));
    return changes;
}

// Adds the constant data of soft objects and of objects with a model.
SceneChange Scene::described(const bus::SceneObject& object) const {
    SceneChange change{.object = object};
    const auto parts = parts_.find(object.object);
    // a simple object may reuse the id of a removed one
    const bool is_model =
        object.shape == bus::Shape::kConvex || object.shape == bus::Shape::kCompound;
    if (is_model && parts != parts_.end())
        change.proxy = make_object_proxy(object.object, *parts->second);
    const physics::SoftTopology* topology = world_->soft_topology(object.object);
    if (topology == nullptr) return change;
    const auto node = [](std::uint32_t index) { return static_cast<std::uint16_t>(index); };
    bus::SoftBody& soft = change.soft.emplace();
    soft.object = object.object;
    soft.thickness_m = 2.0 * topology->radius_m;
    for (const auto& [a, b, c] : topology->triangles)
        soft.triangles.push_back({node(a), node(b), node(c)});
    for (const auto& [a, b] : topology->segments) soft.segments.push_back({node(a), node(b)});
    soft.num_nodes = static_cast<std::uint32_t>(world_->num_soft_nodes(object.object));
    return change;
}

void Scene::get_soft_states(Timestamp time, std::vector<bus::SoftBodyState>& states) {
    std::size_t num = 0;
    for (const auto& [id, object] : objects_) {
        if (object.shape != bus::Shape::kSoft) continue;
        if (num == states.size()) states.emplace_back();
        bus::SoftBodyState& state = states[num++];
        state.object = id;
        state.tick = world_->counters().num_ticks;
        state.time = time;
        world_->get_soft_nodes(id, nodes_);
        bus::quantise(nodes_, state);
    }
    states.resize(num);
}

void Scene::get_state(const std::string& name, Timestamp time, bus::SceneState& state) {
    world_->get_states(states_);
    state.world = name;
    state.tick = world_->counters().num_ticks;
    state.time = time;
    state.objects.clear();
    for (const physics::RigidState& s : states_) {
        state.objects.push_back({s.id, s.world_from_object, s.linear_velocity, s.angular_velocity});
    }
}

}  // namespace atrium::world_server
