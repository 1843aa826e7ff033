#pragma once

#include "core/base/expected.hpp"
#include "core/bus/messages.hpp"
#include "world_server/config.hpp"
#include "world_server/description/model_parts.hpp"
#include "world_server/physics/soft/soft_object.hpp"
#include "world_server/physics/world.hpp"
#include "world_server/state_file.hpp"

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace atrium::world_server {

/// A new or removed object.
struct SceneChange {
    bus::SceneObject object;
    bool is_gone = false;
    std::optional<bus::SoftBody> soft = std::nullopt;      // new soft objects only
    std::optional<bus::ObjectProxy> proxy = std::nullopt;  // new objects with a model only
};

/// Effect of an edit.
struct EditOutcome {
    std::vector<SceneChange> changes;
    std::uint32_t object = 0;
    std::uint32_t revision = 0;
    std::string text;  // for the sender; empty: nothing to add
};

/// Holds the objects as viewers know them and as the physics moves them. No network. Not
/// thread-safe.
class Scene {
public:
    /// Creates the scene of `config`. Fails with kConfiguration if the physics refuses an object.
    static Expected<Scene> create(const WorldServerConfig& config);

    /// Restores the saved scene of `config`. Fails with kInvalidData if the state belongs to
    /// another world description.
    static Expected<Scene> restore(const WorldServerConfig& config, const SavedWorld& saved);
    /// Saves the state for `restore`. This scene continues like a restored one: equal input gives
    /// bit-identical states, once all people in it have been seen again.
    void save(SavedWorld& saved);

    /// Executes a command and returns the changes in the list of objects. If the command is not
    /// valid, fails with kInvalidData and changes nothing.
    ///
    /// kAdd: object id 0 gets the next free id from 1000. kRemove: not for fixed parts of the world
    /// file. kPush: at most the impulse that accelerates the object to the speed limit. kSave and
    /// kRestore are not handled here.
    Expected<std::vector<SceneChange>> apply(const bus::SceneCommand& command);

    /// Executes an edit of an object. `parts`: hulls of the model of an object to add; null without
    /// a model. Fails with kInvalidData and the reason, and changes nothing, if the edit is not
    /// valid or somebody else has changed or holds the object. kSaveWorld and kLoadWorld are not
    /// handled here.
    ///
    /// kAdd with a target brings that removed object back. kPlace keeps the start of a joined
    /// object.
    Expected<EditOutcome> edit(const bus::SceneEdit& edit, const ModelParts& parts);

    /// The world that this scene was created from.
    const WorldDescription& description() const { return *world_description_; }
    /// Hash of what is described, as far as a saved state depends on it.
    std::uint64_t description_hash() const { return description_; }
    /// Name of the saved world that this scene was loaded from; empty: the server's own.
    const std::string& loaded() const { return loaded_; }
    /// Rigid objects as they are now: joined ones at their start, the others where they are.
    std::vector<WorldObject> current_objects() const;
    /// With the places of their nodes, except where an object that moves is tied to one.
    std::vector<WorldSoftObject> current_soft_objects() const;

    /// Releases everything that a departed sender holds.
    void forget_sender(const std::string& sender) { world_->release_all(sender); }
    /// Takes the incidents since the last call, for the log. Returns the removed objects.
    std::vector<SceneChange> take_removed(std::vector<physics::Incident>& incidents);

    physics::World& world() { return *world_; }
    const physics::World& world() const { return *world_; }
    /// Name of an object; empty if the id is unknown.
    std::string name_of(std::uint32_t id) const;
    std::vector<bus::SceneObject> objects() const;
    /// Returns all objects as if they were new, in the order of their ids.
    std::vector<SceneChange> all() const;
    std::size_t num_objects() const { return objects_.size(); }  // soft ones, too
    std::size_t num_soft() const;
    /// Writes the states of all rigid objects. `time`: scheduled time of the tick.
    void get_state(const std::string& name, Timestamp time, bus::SceneState& state);
    /// Writes the node positions of all soft objects, in the order of their ids.
    void get_soft_states(Timestamp time, std::vector<bus::SoftBodyState>& states);

private:
    explicit Scene(const physics::WorldOptions& options);
    Expected<void> add_soft(const WorldSoftObject& soft);
    Expected<std::vector<SceneChange>> add(const bus::SceneObject& object);
    Expected<std::vector<SceneChange>> remove(std::uint32_t id);
    Expected<std::vector<SceneChange>> remove_for(const bus::SceneCommand& command);
    Expected<std::vector<SceneChange>> push(const bus::SceneCommand& command);
    Expected<std::vector<SceneChange>> hold(const bus::SceneCommand& command);
    Expected<EditOutcome> add(const bus::SceneEdit& edit, const ModelParts& parts);
    Expected<EditOutcome> bring_back(const bus::SceneEdit& edit);
    Expected<EditOutcome> change(const bus::SceneEdit& edit);
    Expected<EditOutcome> place(const bus::SceneEdit& edit);
    Expected<EditOutcome> hold(const bus::SceneEdit& edit);
    std::string why_gone(std::uint32_t id) const;
    Expected<void> check_target(const bus::SceneEdit& edit) const;
    EditOutcome done(const bus::SceneEdit& edit, std::uint32_t object);
    Expected<void> put(const bus::SceneObject& object, const ModelParts& parts);
    Expected<void> restore_edited(const bus::SceneObject& object);
    void note_removed(const bus::SceneObject& object);
    bool is_fixed_part(std::uint32_t id) const;
    std::uint64_t hash_description() const;
    SceneChange described(const bus::SceneObject& object) const;

    physics::WorldOptions options_;
    std::unique_ptr<physics::World> world_;
    std::map<std::uint32_t, bus::SceneObject> objects_;
    std::map<std::uint32_t, ModelParts> parts_;  // parts of objects with a model
    std::shared_ptr<const WorldDescription> world_description_;
    std::string loaded_;
    struct Edited {
        std::uint32_t revision = 0;
        std::string by;  // empty: before the world was loaded
    };
    std::map<std::uint32_t, Edited> edited_;  // objects in the world, and removed ones
    struct Removed {
        bus::SceneObject object;
        physics::RigidObject rigid;
        geometry::RigidTransform pose;
    };
    std::map<std::uint32_t, Removed> removed_;  // the latest; others cannot be brought back
    std::vector<std::uint32_t> removed_order_;  // oldest first
    std::uint32_t num_described_ = 0;           // ids 1 .. num_described_ belong to the world file
    std::uint64_t description_ = 0;             // hash of the described objects
    std::uint64_t world_file_hash_ = 0;         // see WorldServerConfig
    std::uint32_t next_id_ = 1000;
    std::vector<physics::RigidState> states_;  // scratch, like nodes_
    std::vector<Eigen::Vector3f> nodes_;
};

}  // namespace atrium::world_server
