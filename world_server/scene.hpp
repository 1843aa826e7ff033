#pragma once

#include "core/base/expected.hpp"
#include "core/bus/messages.hpp"
#include "world_server/config.hpp"
#include "world_server/physics/world.hpp"

#include <cstdint>
#include <map>
#include <vector>

namespace atrium::world_server {

/// An object that is new or gone.
struct SceneChange {
    bus::SceneObject object;
    bool is_gone = false;
};

/// The objects as the viewers know them and as the physics moves them. Not thread-safe; no network.
class Scene {
public:
    /// Fails with kConfiguration where the physics refuses an object.
    static Expected<Scene> create(const WorldServerConfig& config);

    /// Carries out one command of anybody; returns what changed in the list of objects. Fails with
    /// kInvalidData, and changes nothing, where the command makes no sense.
    ///
    /// kAdd: an object id of 0 gets the next free one from 1000 on. kRemove: not what the world
    /// file describes as fixed. kPush: at most the impulse that brings the object to the speed
    /// limit.
    Expected<std::vector<SceneChange>> apply(const bus::SceneCommand& command);

    /// What the physics did on its own since the last call, for the log, and what it removed.
    std::vector<SceneChange> take_removed(std::vector<physics::Incident>& incidents);

    physics::World& world() { return *world_; }
    /// In the order of their ids.
    std::vector<bus::SceneObject> objects() const;
    void get_state(const std::string& name, bus::SceneState& state);

private:
    explicit Scene(const physics::WorldOptions& options);
    Expected<std::vector<SceneChange>> add(const bus::SceneObject& object);
    Expected<std::vector<SceneChange>> remove(std::uint32_t id);
    Expected<std::vector<SceneChange>> push(const bus::SceneCommand& command);

    physics::WorldOptions options_;
    std::unique_ptr<physics::World> world_;
    std::map<std::uint32_t, bus::SceneObject> objects_;
    std::uint32_t num_described_ = 0;  // ids 1..num_described_ are those of the world file
    std::uint32_t next_id_ = 1000;
    std::vector<physics::RigidState> states_;  // scratch
};

}  // namespace atrium::world_server
