#pragma once

#include "core/bus/messages.hpp"
#include "viewer/renderer/view_camera.hpp"

#include <Eigen/Core>

#include <chrono>
#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

namespace atrium::viewer {

/// A thing that somebody wants in the world.
struct NewThing {
    bus::Shape shape = bus::Shape::kSphere;    // box, sphere, cylinder or capsule
    Eigen::Vector3d size_m{0.25, 0.25, 0.25};  // box: extents; else diameter, unused, height
    double mass_kg = 0.5;
    Eigen::Vector3d colour = Eigen::Vector3d::Constant(0.7);  // linear RGB in [0, 1]
    std::string name;  // what the bus does not take is replaced
};

/// As the bus and the physics take it, before the eye and above the floor (z = 0): so far away that
/// it is still in the picture when it has fallen, and at most 6 m.
bus::SceneObject make_object(const NewThing& thing, const renderer::EyeView& eye);

/// Asks the world server to put things into the world and to take them out, and finds out what
/// became of it: the server does not answer who asks, so that only the world can tell.
class SceneEditor {
public:
    using Clock = std::chrono::steady_clock;
    using Objects = std::map<std::uint32_t, bus::SceneObject>;   // that are in the world
    static constexpr std::chrono::milliseconds kPatience{2500};  // reports come once a second

    /// What world servers say of themselves.
    struct Servers {
        bool are_there = false;
        std::uint64_t num_refused = 0;  // commands, of all senders
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

    /// Of what was done since the last call, or was not within kPatience.
    std::vector<Outcome> outcomes(const Objects& objects,
                                  const Servers& servers,
                                  Clock::time_point now);

private:
    struct Wish {
        std::string name;
        Clock::time_point since;
        std::uint64_t num_refused = 0;      // by then
        std::optional<std::uint32_t> gone;  // the object to go; none: one of that name is to come
        std::set<std::uint32_t> before;     // of that name, when it was asked for
    };
    bus::SceneCommand command(bus::CommandKind kind) const;
    void remember(Wish wish);
    std::string reason(const Wish& wish, const Servers& servers) const;
    bool is_fulfilled(const Wish& wish, const Objects& objects);

    std::string sender_;
    std::uint64_t num_refused_ = 0;  // so far
    std::vector<Wish> wishes_;       // the oldest first
};

}  // namespace atrium::viewer
