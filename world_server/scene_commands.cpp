// The commands of a scene (SceneCommand), except for those of the state file.
#include "core/bus/checks.hpp"
#include "world_server/scene.hpp"
#include "world_server/scene_messages.hpp"

#include <fmt/format.h>

#include <utility>

namespace atrium::world_server {
namespace {

tl::unexpected<Error> refuse_command(std::string why) {
    return make_error(ErrorKind::kInvalidData, std::move(why));
}

}  // namespace

Expected<std::vector<SceneChange>> Scene::add(const bus::SceneObject& object) {
    if (const auto valid = bus::check(object); !valid) return tl::unexpected(valid.error());
    if (object.shape > bus::Shape::kPlane) {
        return refuse_command("add: must be a box, sphere, cylinder, capsule or plane");
    }
    bus::SceneObject added = object;
    if (object.object == 0) {
        while (objects_.contains(next_id_)) ++next_id_;
        added.object = next_id_++;
    }
    if (auto in_world = put(added, {}); !in_world) return tl::unexpected(in_world.error());
    return std::vector<SceneChange>{{added, false}};
}

Expected<void> Scene::put(const bus::SceneObject& added, const ModelParts& parts) {
    physics::RigidObject rigid = to_rigid(added);
    rigid.parts = parts;
    if (parts && parts->size() == 1) rigid.shape = physics::ObjectShape::kConvex;
    if (const auto problem = physics::find_problem(rigid)) {
        if (parts && problem->field == "size_m") {
            const Eigen::Vector3d& s = rigid.size_m;
            return refuse_command(
                fmt::format("add: the model {}, it is {:.3g} x {:.3g} x {:.3g} m: change its scale",
                            problem->allowed,
                            s.x(),
                            s.y(),
                            s.z()));
        }
        return refuse_command(fmt::format("add: {} {}", problem->field, problem->allowed));
    }
    if (!box_of(options_).contains(added.world_from_object.translation)) {
        return refuse_command("add: the position is outside the world");
    }
    switch (world_->add(rigid)) {
        case physics::AddResult::kAdded:
            objects_[added.object] = added;
            if (parts)
                parts_[added.object] = parts;
            else
                parts_.erase(added.object);
            return {};
        case physics::AddResult::kIdInUse:
            return refuse_command(fmt::format("add: object {} already exists", added.object));
        case physics::AddResult::kWorldFull:
            return refuse_command(
                fmt::format("add: the world is full, it has {} objects", options_.max_objects));
        case physics::AddResult::kInvalid:
            break;
    }
    return refuse_command("add: the object is not valid");
}

Expected<std::vector<SceneChange>> Scene::remove(std::uint32_t id) {
    const auto found = objects_.find(id);
    if (found == objects_.end())
        return refuse_command(fmt::format("remove: there is no object {}", id));
    if (is_fixed_part(id)) {
        return refuse_command(fmt::format("remove: object {} is a fixed part of the world", id));
    }
    const SceneChange change{found->second, true};
    note_removed(found->second);
    world_->remove(id);
    objects_.erase(found);
    return std::vector<SceneChange>{change};
}

Expected<std::vector<SceneChange>> Scene::remove_for(const bus::SceneCommand& command) {
    auto removed = remove(command.target);
    if (removed && removed_.contains(command.target)) {
        Edited& edited = edited_[command.target];
        ++edited.revision;
        edited.by = command.sender;
    }
    return removed;
}

Expected<std::vector<SceneChange>> Scene::push(const bus::SceneCommand& command) {
    const auto found = objects_.find(command.target);
    if (found == objects_.end() || found->second.mass_kg == 0.0) {
        return refuse_command(
            fmt::format("push: object {} does not exist or is static", command.target));
    }
    const double limit_ns = found->second.mass_kg * options_.max_speed_mps;
    if (!(command.impulse_ns.norm() <= limit_ns)) {
        return refuse_command(fmt::format(
            "push: must be at most {:.3g} N s for object {}", limit_ns, command.target));
    }
    world_->push(command.target, command.impulse_ns);
    return std::vector<SceneChange>{};
}

Expected<std::vector<SceneChange>> Scene::hold(const bus::SceneCommand& command) {
    const std::uint32_t target = command.target;
    if (command.kind == bus::CommandKind::kRelease) {
        // releasing a released or removed object is not an error
        world_->release(command.sender, target);
    } else if (command.kind == bus::CommandKind::kMove) {
        if (!world_->move_grab(command.sender, target, command.goal_world)) {
            return refuse_command(fmt::format("move: the sender does not hold object {}", target));
        }
    } else if (!world_->grab(command.sender, target, command.point_object, command.goal_world)) {
        return refuse_command(fmt::format(
            "grab: object {} does not exist or is static, or too many objects are held", target));
    }
    return std::vector<SceneChange>{};
}

std::vector<SceneChange> Scene::take_removed(std::vector<physics::Incident>& incidents) {
    world_->take_incidents(incidents);
    std::vector<SceneChange> changes;
    for (const physics::Incident& incident : incidents) {
        const auto found = objects_.find(incident.object);
        if (incident.kind != physics::IncidentKind::kRemoved || found == objects_.end()) continue;
        changes.push_back({.object = found->second, .is_gone = true});
        edited_.erase(incident.object);
        objects_.erase(found);
    }
    return changes;
}

}  // namespace atrium::world_server
