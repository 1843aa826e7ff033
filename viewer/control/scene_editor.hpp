#pragma once

#include "core/bus/messages.hpp"
#include "viewer/control/edit_events.hpp"
#include "viewer/renderer/drawing/view_camera.hpp"

#include <Eigen/Core>

#include <chrono>
#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

namespace atrium::viewer {

/// An object that the user wants to add.
struct NewObject {
    bus::Shape shape = bus::Shape::kSphere;    // box, sphere, cylinder or capsule
    Eigen::Vector3d size_m{0.25, 0.25, 0.25};  // box: extents; others: diameter, unused, height
    double mass_kg = 0.5;
    Eigen::Vector3d colour = Eigen::Vector3d::Constant(0.7);  // linear RGB in [0, 1]
    std::string name;                                         // invalid characters are replaced
};

/// A circle on the floor that a person or an object covers [m, world].
struct TakenPlace {
    Eigen::Vector2d middle;
    double radius_m;
};

/// Builds an object that bus and physics accept. Places it before the eye and above the floor
/// (z=0), far enough that it stays visible when it falls, but at most 6 m away; aside of what is
/// `taken`, if there is a free place in the picture. If one of `objects` has its name, it gets the
/// next free one (crate, crate_2, crate_3).
bus::SceneObject make_object(const NewObject& wanted,
                             const renderer::EyeView& eye,
                             const std::vector<TakenPlace>& taken = {},
                             const std::map<std::uint32_t, bus::SceneObject>& objects = {});

/// Builds an object of a model. It is placed and named like others.
bus::SceneObject make_object(const NewModel& wanted,
                             const renderer::EyeView& eye,
                             const std::vector<TakenPlace>& taken = {},
                             const std::map<std::uint32_t, bus::SceneObject>& objects = {});

/// Copies an object that stands at `pose`. The copy has a name that no object has (crate, crate_2,
/// crate_3) and stands beside it, at its height, aside of what is `taken`.
bus::SceneObject make_copy(const bus::SceneObject& original,
                           const geometry::RigidTransform& pose,
                           const std::map<std::uint32_t, bus::SceneObject>& objects,
                           const renderer::EyeView& eye,
                           std::vector<TakenPlace> taken);

/// Builds the commands that add and remove objects, and detects whether they took effect. The
/// server does not reply, so the editor watches the objects of the world.
class SceneEditor {
public:
    using Clock = std::chrono::steady_clock;
    using Objects = std::map<std::uint32_t, bus::SceneObject>;   // objects in the world
    static constexpr std::chrono::milliseconds kPatience{2500};  // the server reports once a second

    /// Status of the world servers.
    struct Servers {
        bool are_there = false;
        std::uint64_t num_refused = 0;  // commands of all senders
    };
    struct Outcome {
        std::string text;
        bool is_done = false;
    };

    explicit SceneEditor(std::string sender) : sender_(std::move(sender)) {}

    bus::SceneCommand reset() const { return command(bus::CommandKind::kReset); }
    bus::SceneCommand add(const bus::SceneObject& object,
                          const Objects& objects,
                          Clock::time_point now);
    bus::SceneCommand remove(std::uint32_t object, const Objects& objects, Clock::time_point now);

    /// Returns the commands that took effect since the last call, and those that did not within
    /// kPatience.
    std::vector<Outcome> outcomes(const Objects& objects,
                                  const Servers& servers,
                                  Clock::time_point now);

private:
    struct PendingCommand {
        std::string name;
        Clock::time_point since;
        std::uint64_t num_refused = 0;  // at the time of the command
        /// Object to remove; none: an object of this name is to appear.
        std::optional<std::uint32_t> gone;
        std::set<std::uint32_t> before;  // objects of that name at the time of the command
    };
    bus::SceneCommand command(bus::CommandKind kind) const;
    void add_pending(PendingCommand pending);
    std::string reason(const PendingCommand& pending, const Servers& servers) const;
    bool took_effect(const PendingCommand& pending, const Objects& objects);

    std::string sender_;
    std::uint64_t num_refused_ = 0;        // latest count
    std::vector<PendingCommand> pending_;  // oldest first
};

}  // namespace atrium::viewer
