#pragma once

#include "core/base/expected.hpp"
#include "core/bus/messages.hpp"
#include "world_server/config.hpp"
#include "world_server/physics/soft_object.hpp"
#include "world_server/physics/world.hpp"
#include "world_server/state_file.hpp"

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <vector>

namespace atrium::world_server {

/// An object that is new or gone.
struct SceneChange {
    bus::SceneObject object;
    bool is_gone = false;
    std::optional<bus::SoftBody> soft = std::nullopt;      // of a soft object that is new
    std::optional<bus::ObjectProxy> proxy = std::nullopt;  // of one with a model that is new
};

/// The objects as the viewers know them and as the physics moves them. Not thread-safe; no network.
class Scene {
public:
    /// Fails with kConfiguration where the physics refuses an object.
    static Expected<Scene> create(const WorldServerConfig& config);

    /// The scene of `config` as it was when it was saved. Fails with kInvalidData where the state
    /// is of another world than the one described.
    static Expected<Scene> restore(const WorldServerConfig& config, const SavedWorld& saved);
    /// What `restore` needs. The scene itself goes on as a restored one would: bit by bit the same
    /// from the same input, once everybody in it has been seen anew.
    void save(SavedWorld& saved);

    /// Carries out one command of anybody; returns what changed in the list of objects. Fails with
    /// kInvalidData, and changes nothing, where the command makes no sense.
    ///
    /// kAdd: an object id of 0 gets the next free one from 1000 on. kRemove: not what the world
    /// file describes as fixed. kPush: at most the impulse that brings the object to the speed
    /// limit. kSave and kRestore are not the scene's.
    Expected<std::vector<SceneChange>> apply(const bus::SceneCommand& command);

    /// A sender is gone, and lets go of what it holds.
    void forget_sender(const std::string& sender) { world_->release_all(sender); }
    /// What the physics did on its own since the last call, for the log, and what it removed.
    std::vector<SceneChange> take_removed(std::vector<physics::Incident>& incidents);

    physics::World& world() { return *world_; }
    const physics::World& world() const { return *world_; }
    /// In the order of their ids.
    std::string name_of(std::uint32_t id) const;  // empty: there is none of that id
    std::vector<bus::SceneObject> objects() const;
    /// All of them, as if they were new.
    std::vector<SceneChange> all() const;
    std::size_t num_objects() const { return objects_.size(); }
    /// `time`: when the tick was due.
    void get_state(const std::string& name, Timestamp time, bus::SceneState& state);
    /// Where the nodes of all soft objects are, in the order of their ids.
    void get_soft_states(Timestamp time, std::vector<bus::SoftBodyState>& states);

private:
    explicit Scene(const physics::WorldOptions& options);
    Expected<void> add_soft(const WorldSoftObject& soft);
    Expected<std::vector<SceneChange>> add(const bus::SceneObject& object);
    Expected<std::vector<SceneChange>> remove(std::uint32_t id);
    Expected<std::vector<SceneChange>> push(const bus::SceneCommand& command);
    Expected<std::vector<SceneChange>> hold(const bus::SceneCommand& command);
    std::uint64_t hash_description() const;
    SceneChange described(const bus::SceneObject& object) const;

    physics::WorldOptions options_;
    std::unique_ptr<physics::World> world_;
    std::map<std::uint32_t, bus::SceneObject> objects_;
    using Parts = std::shared_ptr<const std::vector<geometry::TriangleMesh>>;
    std::map<std::uint32_t, Parts> parts_;  // of described objects made of some
    std::uint32_t num_described_ = 0;       // ids 1..num_described_ are those of the world file
    std::uint64_t description_ = 0;         // their hash
    std::uint32_t next_id_ = 1000;
    std::vector<physics::RigidState> states_;  // scratch, as is the next one
    std::vector<Eigen::Vector3f> nodes_;
};

}  // namespace atrium::world_server
