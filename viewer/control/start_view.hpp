#pragma once

#include "viewer/control/follow_camera.hpp"
#include "viewer/renderer/drawing/view_camera.hpp"

#include <cstddef>
#include <map>
#include <optional>
#include <string>

namespace atrium::viewer {

/// A viewpoint from which all these people, at least one, are wholly in the picture: from the
/// front, 30 degrees aside, if their sites have one and most agree, else from the side of `usual`.
/// Never nearer than for somebody who stands, and never below the floor. `aspect`: width of the
/// picture by its height.
renderer::ViewCamera view_of_people(const FollowCamera::Places& people,
                                    const renderer::ViewCamera& usual,
                                    double aspect);

/// Chooses the first viewpoint of a run whose user gave none: once, when the first people are
/// there, and again when all of them have left and others are there. Not thread-safe.
class StartView {
public:
    /// Waits for `num_people`, at least one; looks from the side of `usual` if no front is known.
    /// Not `is_wanted`: never chooses.
    StartView(const renderer::ViewCamera& usual, std::size_t num_people, bool is_wanted)
        : usual_(usual), num_people_(num_people), is_wanted_(is_wanted) {}

    /// Call before each picture. Returns the viewpoint when the people come, and again when the
    /// site of one of them gets its place in the world; else nothing.
    std::optional<renderer::ViewCamera> update(const FollowCamera::Places& people, double aspect);

private:
    renderer::ViewCamera usual_;
    std::size_t num_people_;
    bool is_wanted_;
    std::map<std::string, bool> framed_;  // by name: whether its site had a place
};

}  // namespace atrium::viewer
