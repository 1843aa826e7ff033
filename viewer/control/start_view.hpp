#pragma once

#include "viewer/control/follow_camera.hpp"
#include "viewer/control/mouse_grab.hpp"
#include "viewer/renderer/drawing/view_camera.hpp"

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <map>
#include <optional>
#include <string>

namespace atrium::viewer {

/// What may stand between an eye and people.
struct Sight {
    /// How far along a ray nothing fixed hides what is behind it [m].
    std::function<double(const Ray&)> free_m = [](const Ray&) {
        return std::numeric_limits<double>::infinity();
    };
    /// The same for things that may move away: they count less.
    std::function<double(const Ray&)> free_of_loose_m = [](const Ray&) {
        return std::numeric_limits<double>::infinity();
    };
    bool is_complete = true;     // all models of the world are loaded
    std::uint64_t revision = 0;  // of the things in the world
};

/// A viewpoint from which all these people, at least one, are wholly in the picture: from the
/// front, 30 degrees aside, if their sites have one and most agree, else from the side of `usual`.
/// If something hides them there, from the next side that is free, or from above; things that may
/// move away then hide them rather than fixed ones. In a closed room from as far as it is free.
/// Never nearer than for somebody who stands, unless the room is small, and never below the floor.
/// `aspect`: width of the picture by its height.
renderer::ViewCamera view_of_people(const FollowCamera::Places& people,
                                    const renderer::ViewCamera& usual,
                                    double aspect,
                                    const Sight& sight = {});

/// Chooses the first viewpoint of a run whose user gave none: once, when the first people are
/// there, and again when all of them have left and others are there. Waits for the models of the
/// world for some seconds, and looks again when things come meanwhile. Not thread-safe.
class StartView {
public:
    /// Waits for `num_people`, at least one; looks from the side of `usual` if no front is known.
    /// Not `is_wanted`: never chooses.
    StartView(const renderer::ViewCamera& usual, std::size_t num_people, bool is_wanted)
        : usual_(usual), num_people_(num_people), is_wanted_(is_wanted) {}

    using Clock = std::chrono::steady_clock;
    /// Call before each picture. Returns the viewpoint when the people come, and again when the
    /// site of one of them gets its place in the world; else nothing.
    std::optional<renderer::ViewCamera> update(const FollowCamera::Places& people,
                                               double aspect,
                                               const Sight& sight,
                                               Clock::time_point now);

private:
    renderer::ViewCamera choose(const FollowCamera::Places& people,
                                double aspect,
                                const Sight& sight);

    renderer::ViewCamera usual_;
    std::size_t num_people_;
    bool is_wanted_;
    std::map<std::string, bool> framed_;        // by name: whether its site had a place
    std::optional<Clock::time_point> came_at_;  // when the people to be framed were there
    std::uint64_t seen_revision_ = 0;           // Sight::revision of the last choice
};

}  // namespace atrium::viewer
