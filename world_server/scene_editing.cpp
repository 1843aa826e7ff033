// The edits of a scene (SceneEdit).
#include "world_server/physics/soft/soft_mesh.hpp"
#include "world_server/scene.hpp"
#include "world_server/scene_messages.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <utility>

namespace atrium::world_server {
namespace {

constexpr std::size_t kMaxRemoved = 256;  // removed objects that can be brought back

tl::unexpected<Error> refuse_edit(std::string why) {
    return make_error(ErrorKind::kInvalidData, std::move(why));
}

std::string outside(const geometry::Aabb& box) {
    return fmt::format("the place is outside the world, which reaches from [{:.4g}] to [{:.4g}] m",
                       fmt::join(box.min, ", "),
                       fmt::join(box.max, ", "));
}

bool is_simple(bus::Shape shape) { return shape < bus::Shape::kConvex; }

}  // namespace

bool Scene::is_fixed_part(std::uint32_t id) const {
    const auto& objects = world_description_->objects;
    return id >= 1 && id <= objects.size() && objects[id - 1].rigid.mass_kg == 0.0;
}

void Scene::note_removed(const bus::SceneObject& object) {
    const physics::RigidObject* rigid = world_->object(object.object);
    const auto pose = world_->pose_of(object.object);
    if (rigid == nullptr || !pose) return;  // soft
    removed_[object.object] = {object, *rigid, *pose};
    removed_order_.push_back(object.object);
    if (removed_order_.size() <= kMaxRemoved) return;
    const std::uint32_t oldest = removed_order_.front();
    removed_order_.erase(removed_order_.begin());
    removed_.erase(oldest);
    if (!objects_.contains(oldest)) edited_.erase(oldest);
}

EditOutcome Scene::done(const bus::SceneEdit& edit, std::uint32_t object) {
    Edited& edited = edited_[object];
    ++edited.revision;
    edited.by = edit.sender;
    EditOutcome outcome;
    const auto found = objects_.find(object);
    if (found != objects_.end()) outcome.changes.push_back(described(found->second));
    outcome.object = object;
    outcome.revision = edited.revision;
    return outcome;
}

// Why an object that a viewer knew is no longer there, for the user.
std::string Scene::why_gone(std::uint32_t id) const {
    const auto removed = removed_.find(id);
    if (removed == removed_.end())
        return fmt::format(
            "there is no object {} any more: it was removed, or the world was loaded again", id);
    const auto edited = edited_.find(id);
    const bool is_known = edited != edited_.end() && !edited->second.by.empty();
    return removed->second.object.name + " was removed" +
           (is_known ? " by " + edited->second.by : "");
}

// Checks that the object exists, and that nobody else has edited it meanwhile or holds it.
Expected<void> Scene::check_target(const bus::SceneEdit& edit) const {
    const auto found = objects_.find(edit.target);
    if (found == objects_.end()) return refuse_edit(why_gone(edit.target));
    const std::string& name = found->second.name;
    const std::string holder = world_->holder_of(edit.target);
    if (!holder.empty() && holder != edit.sender)
        return refuse_edit(fmt::format("{} is held by {}", name, holder));
    const auto edited = edited_.find(edit.target);
    const std::uint32_t revision = edited == edited_.end() ? 0 : edited->second.revision;
    if (edit.revision != bus::SceneEdit::kAnyRevision && edit.revision != revision) {
        if (edited == edited_.end() || edited->second.by.empty())
            return refuse_edit("the world was loaded again");
        return refuse_edit(fmt::format("{} was changed by {} meanwhile", name, edited->second.by));
    }
    return {};
}

Expected<EditOutcome> Scene::edit(const bus::SceneEdit& edit, const ModelParts& parts) {
    if (edit.kind == bus::EditKind::kAdd)
        return edit.target == 0 ? add(edit, parts) : bring_back(edit);
    if (edit.kind == bus::EditKind::kLetGo) {
        world_->let_go(edit.sender, edit.target);
        EditOutcome outcome;
        outcome.object = edit.target;
        return outcome;
    }
    if (auto fine = check_target(edit); !fine) return tl::unexpected(fine.error());
    switch (edit.kind) {
        case bus::EditKind::kChange:
            return change(edit);
        case bus::EditKind::kPlace:
            return place(edit);
        case bus::EditKind::kHold:
            return hold(edit);
        case bus::EditKind::kRemove: {
            auto removed = remove(edit.target);
            if (!removed) return tl::unexpected(removed.error());
            EditOutcome outcome = done(edit, edit.target);
            outcome.changes = std::move(*removed);
            return outcome;
        }
        default:
            return refuse_edit("unknown kind of edit");
    }
}

Expected<EditOutcome> Scene::add(const bus::SceneEdit& edit, const ModelParts& parts) {
    bus::SceneObject added = edit.object;
    if (added.shape == bus::Shape::kSoft) return refuse_edit("a soft object cannot be added");
    while (objects_.contains(next_id_) || removed_.contains(next_id_)) ++next_id_;
    added.object = next_id_;
    if (parts) added.size_m = physics::extents_of(*parts);
    if (auto in_world = put(added, parts); !in_world) return tl::unexpected(in_world.error());
    ++next_id_;
    return done(edit, added.object);
}

Expected<EditOutcome> Scene::bring_back(const bus::SceneEdit& edit) {
    const auto found = removed_.find(edit.target);
    if (objects_.contains(edit.target))
        return refuse_edit(fmt::format("object {} is in the world already", edit.target));
    if (found == removed_.end())
        return refuse_edit(
            "the world server no longer knows the removed object: the world was loaded again, "
            "or many others were removed since");
    const Removed& removed = found->second;
    switch (world_->add(removed.rigid)) {
        case physics::AddResult::kAdded:
            break;
        case physics::AddResult::kWorldFull:
            return refuse_edit(
                fmt::format("the world is full, it has {} objects", options_.max_objects));
        default:
            return refuse_edit("the removed object is no longer valid");
    }
    world_->place(edit.target, removed.pose);
    objects_[edit.target] = removed.object;
    std::erase(removed_order_, edit.target);
    removed_.erase(found);
    return done(edit, edit.target);
}

Expected<EditOutcome> Scene::change(const bus::SceneEdit& edit) {
    bus::SceneObject changed = objects_.at(edit.target);
    const physics::RigidObject* now = world_->object(edit.target);
    if (now == nullptr) return refuse_edit(changed.name + " is soft: it cannot be changed");
    changed.name = edit.object.name;
    changed.mass_kg = edit.object.mass_kg;
    changed.friction = edit.object.friction;
    changed.restitution = edit.object.restitution;
    changed.colour = edit.object.colour;
    if (is_simple(changed.shape)) changed.size_m = edit.object.size_m;
    physics::RigidObject rigid = *now;
    rigid.mass_kg = changed.mass_kg;
    rigid.friction = changed.friction;
    rigid.restitution = changed.restitution;
    if (is_simple(changed.shape)) rigid.size_m = changed.size_m;
    if (const auto problem = physics::find_problem(rigid))
        return refuse_edit(fmt::format("{} {}", problem->field, problem->allowed));
    if (!world_->change(rigid)) {
        return refuse_edit(fmt::format("{} is joined to something: it keeps its size, and stays {}",
                                       changed.name,
                                       now->mass_kg == 0.0 ? "fixed" : "movable"));
    }
    objects_[edit.target] = changed;
    return done(edit, edit.target);
}

Expected<EditOutcome> Scene::place(const bus::SceneEdit& edit) {
    bus::SceneObject& object = objects_.at(edit.target);
    if (world_->object(edit.target) == nullptr)
        return refuse_edit(object.name + " is soft: it cannot be placed, only pulled");
    const geometry::Aabb box = box_of(options_);
    if (!box.contains(edit.world_from_object.translation) ||
        !box.contains(edit.object.world_from_object.translation))
        return refuse_edit(outside(box));
    world_->let_go(edit.sender, edit.target);
    world_->place(edit.target, edit.world_from_object);
    const bool is_joined = world_->is_joined(edit.target);
    if (!is_joined) {
        object.world_from_object = edit.object.world_from_object;
        world_->set_start(edit.target, object.world_from_object);
    }
    EditOutcome outcome = done(edit, edit.target);
    if (is_joined) outcome.text = object.name + " is joined to something: its start stays";
    return outcome;
}

Expected<EditOutcome> Scene::hold(const bus::SceneEdit& edit) {
    const std::string& name = objects_.at(edit.target).name;
    const geometry::Aabb box = box_of(options_);
    if (!box.contains(edit.world_from_object.translation))
        return refuse_edit(name + ": " + outside(box));
    switch (world_->hold(edit.sender, edit.target, edit.world_from_object)) {
        case physics::HoldResult::kHeld:
            break;
        case physics::HoldResult::kUnknownObject:
            return refuse_edit(name + " is soft: it cannot be placed, only pulled");
        case physics::HoldResult::kTooMany:
            return refuse_edit(name + " cannot be held: too many objects are held");
        case physics::HoldResult::kHeldByOther:
            return refuse_edit(name + " is held by somebody else");
    }
    EditOutcome outcome;
    outcome.object = edit.target;
    return outcome;
}

// Gives a described object the properties of a saved one.
Expected<void> Scene::restore_edited(const bus::SceneObject& object) {
    const auto found = objects_.find(object.object);
    const physics::RigidObject* now = world_->object(object.object);
    if (found == objects_.end() || now == nullptr)
        return refuse_edit("world state: an edited object is not in the world");
    physics::RigidObject rigid = *now;
    rigid.mass_kg = object.mass_kg;
    rigid.friction = object.friction;
    rigid.restitution = object.restitution;
    if (is_simple(object.shape)) rigid.size_m = object.size_m;
    if (!world_->change(rigid)) {
        return refuse_edit(
            fmt::format("world state: object {} cannot be as it was edited", object.object));
    }
    world_->set_start(object.object, object.world_from_object);
    const bus::SceneObject described = std::exchange(found->second, object);
    found->second.model_fingerprint = described.model_fingerprint;
    found->second.texture_fingerprint = described.texture_fingerprint;
    edited_[object.object] = {1, {}};
    return {};
}

std::vector<WorldObject> Scene::current_objects() const {
    std::vector<WorldObject> current;
    for (const auto& [id, object] : objects_) {
        const physics::RigidObject* rigid = world_->object(id);
        if (rigid == nullptr) continue;
        WorldObject& written = current.emplace_back();
        written.name = object.name;
        written.look = {object.model, object.model_scale, object.texture, object.colour};
        written.rigid = *rigid;
        written.rigid.shape = static_cast<physics::ObjectShape>(object.shape);
        written.rigid.size_m = object.size_m;  // a plane's drawn size
        constexpr double kAtStart = 1e-5;      // [m]; below, an object rests where it began
        const geometry::RigidTransform pose =
            world_->pose_of(id).value_or(rigid->world_from_object);
        const geometry::RigidTransform& start = rigid->world_from_object;
        const bool is_at_start = (pose.translation - start.translation).norm() < kAtStart &&
                                 pose.rotation.angularDistance(start.rotation) < kAtStart;
        if (!world_->is_joined(id) && !is_at_start) written.rigid.world_from_object = pose;
    }
    return current;
}

std::size_t Scene::num_soft() const {
    return static_cast<std::size_t>(std::ranges::count_if(
        objects_, [](const auto& entry) { return entry.second.shape == bus::Shape::kSoft; }));
}

std::vector<WorldSoftObject> Scene::current_soft_objects() const {
    std::vector<WorldSoftObject> current;
    for (const WorldSoftObject& described : world_description_->soft) {
        if (!objects_.contains(described.object.id)) continue;
        physics::SoftObject& soft = current.emplace_back(described).object;
        const auto is_tied_to_moving = [&](const physics::SoftPin& pin) {
            const physics::RigidObject* holder = world_->object(pin.object_id);
            return pin.object_id != 0 && (holder == nullptr || holder->mass_kg > 0.0);
        };
        // such an object is written at its start, to which the tie belongs
        if (std::ranges::any_of(soft.pins, is_tied_to_moving)) continue;
        std::vector<Eigen::Vector3f> nodes;
        if (!world_->get_soft_nodes(soft.id, nodes)) continue;
        constexpr double kAtStart = 1e-4;  // [m]; below, it rests where it began
        const physics::SoftMesh mesh = physics::make_soft_mesh(soft);
        double most_m = 0.0;
        for (std::size_t i = 0; i < nodes.size(); ++i)
            most_m = std::max(
                most_m, (nodes[i].cast<double>() - physics::start_of_node(soft, mesh, i)).norm());
        if (most_m > kAtStart) soft.start_nodes = std::move(nodes);
    }
    return current;
}

}  // namespace atrium::world_server
