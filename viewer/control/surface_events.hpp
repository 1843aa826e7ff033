#pragma once

#include "viewer/control/controls.hpp"
#include "viewer/control/mouse_grab.hpp"
#include "viewer/control/scene_editor.hpp"

#include <cstddef>
#include <cstdint>
#include <optional>

namespace atrium::viewer {

/// Input of the user.
struct SurfaceEvents {
    Motion motion;
    Pointer pointer;  // without a window nothing is pressed
    bool close = false;
    bool screenshot = false;
    bool record = false;  // start or stop a video
    bool stream = false;  // start or stop the stream
    bool names = false;   // show or hide the names of people
    bool debug = false;   // show or hide the debug view
    bool reset_view = false;
    bool follow = false;     // follow a person, or stop following
    std::size_t person = 0;  // person whose eyes to look through, from 1; 0: no change
    bool reset_scene = false;
    std::optional<NewObject> add;         // add this object before the eye
    std::optional<std::uint32_t> remove;  // remove this object
    bool remove_pointed = false;          // remove the object under the pointer
};

}  // namespace atrium::viewer
