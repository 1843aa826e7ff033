#include "world_server/scene.hpp"

#include "core/bus/checks.hpp"

#include <fmt/format.h>

#include <cassert>

namespace atrium::world_server {
namespace {

physics::ObjectShape to_rigid(bus::Shape shape) {
    switch (shape) {
        case bus::Shape::kSphere:
            return physics::ObjectShape::kSphere;
        case bus::Shape::kCylinder:
            return physics::ObjectShape::kCylinder;
        case bus::Shape::kCapsule:
            return physics::ObjectShape::kCapsule;
        case bus::Shape::kPlane:
            return physics::ObjectShape::kPlane;
        case bus::Shape::kBox:
            break;
    }
    return physics::ObjectShape::kBox;
}

tl::unexpected<Error> refuse(std::string why) {
    return make_error(ErrorKind::kInvalidData, std::move(why));
}

}  // namespace

physics::RigidObject to_rigid(const WorldObject& object) {
    return {.id = object.scene.object,
            .shape = to_rigid(object.scene.shape),
            .size_m = object.scene.size_m,
            .mass_kg = object.scene.mass_kg,
            .friction = object.friction,
            .restitution = object.restitution,
            .world_from_object = object.scene.world_from_object};
}

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
                fmt::format("object '{}': has no place in the world: its id {} is in use, or a "
                            "number is out of range",
                            object.scene.name,
                            object.scene.object));
        }
        scene.objects_[object.scene.object] = object.scene;
    }
    for (const WorldSoftObject& soft : config.soft) {
        if (scene.world_->add_soft(soft.object) != physics::AddResult::kAdded) {
            return make_error(
                ErrorKind::kConfiguration,
                fmt::format(
                    "soft object '{}': has no place in the world: all soft objects together "
                    "have more than {} nodes",
                    soft.name,
                    physics::kMaxSoftNodesTotal));
        }
    }
    scene.num_described_ = static_cast<std::uint32_t>(config.objects.size() + config.soft.size());
    return scene;
}

Expected<std::vector<SceneChange>> Scene::apply(const bus::SceneCommand& command) {
    switch (command.kind) {
        case bus::CommandKind::kAdd:
            return add(command.object);
        case bus::CommandKind::kRemove:
            return remove(command.target);
        case bus::CommandKind::kPush:
            return push(command);
        case bus::CommandKind::kReset:
            world_->reset();
            return std::vector<SceneChange>{};
    }
    return refuse("unknown kind of command");
}

Expected<std::vector<SceneChange>> Scene::add(const bus::SceneObject& object) {
    if (const auto valid = bus::check(object); !valid) return tl::unexpected(valid.error());
    WorldObject added{.scene = object};
    if (object.object == 0) {
        while (objects_.contains(next_id_)) ++next_id_;
        added.scene.object = next_id_++;
    }
    if (const auto problem = physics::find_problem(to_rigid(added))) {
        return refuse(fmt::format("add: {} {}", problem->field, problem->allowed));
    }
    const Eigen::Vector3d& position = object.world_from_object.translation;
    if (position.cwiseAbs().maxCoeff() > options_.half_extent_m ||
        position.z() < options_.lowest_z_m) {
        return refuse("add: the position is outside the world");
    }
    switch (world_->add(to_rigid(added))) {
        case physics::AddResult::kAdded:
            objects_[added.scene.object] = added.scene;
            return std::vector<SceneChange>{{added.scene, false}};
        case physics::AddResult::kIdInUse:
            return refuse(fmt::format("add: object {} is there already", added.scene.object));
        case physics::AddResult::kWorldFull:
            return refuse(fmt::format("add: the world has its {} objects", options_.max_objects));
        case physics::AddResult::kInvalid:
            break;
    }
    return refuse("add: the object is not valid");
}

Expected<std::vector<SceneChange>> Scene::remove(std::uint32_t id) {
    const auto found = objects_.find(id);
    if (found == objects_.end()) return refuse(fmt::format("remove: there is no object {}", id));
    if (id <= num_described_ && found->second.mass_kg == 0.0) {
        return refuse(fmt::format("remove: object {} is a fixed part of the world", id));
    }
    const SceneChange change{found->second, true};
    world_->remove(id);
    objects_.erase(found);
    return std::vector<SceneChange>{change};
}

Expected<std::vector<SceneChange>> Scene::push(const bus::SceneCommand& command) {
    const auto found = objects_.find(command.target);
    if (found == objects_.end() || found->second.mass_kg == 0.0) {
        return refuse(fmt::format("push: there is no object {} that moves", command.target));
    }
    const double limit_ns = found->second.mass_kg * options_.max_speed_mps;
    if (!(command.impulse_ns.norm() <= limit_ns)) {
        return refuse(fmt::format(
            "push: must be at most {:.3g} N s for object {}", limit_ns, command.target));
    }
    world_->push(command.target, command.impulse_ns);
    return std::vector<SceneChange>{};
}

std::vector<bus::SceneObject> Scene::objects() const {
    std::vector<bus::SceneObject> objects;
    objects.reserve(objects_.size());
    for (const auto& [id, object] : objects_) objects.push_back(object);
    return objects;
}

void Scene::get_state(const std::string& name, bus::SceneState& state) {
    world_->get_states(states_);
    state.world = name;
    state.tick = world_->counters().num_ticks;
    state.time = Timestamp::now();
    state.objects.clear();
    for (const physics::RigidState& s : states_) {
        state.objects.push_back({s.id, s.world_from_object, s.linear_velocity, s.angular_velocity});
    }
}

}  // namespace atrium::world_server
