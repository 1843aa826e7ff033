#pragma once

#include "viewer/control/controls.hpp"
#include "viewer/control/edit_events.hpp"
#include "viewer/control/mouse_grab.hpp"
#include "viewer/control/scene_editor.hpp"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>

namespace atrium::viewer {

/// Input of the user.
struct SurfaceEvents {
    Motion motion;
    Pointer pointer;  // without a window nothing is pressed
    bool close = false;
    bool screenshot = false;
    bool record = false;  // start or stop a video
    bool names = false;   // show or hide the names of people
    bool debug = false;   // show or hide the debug view
    bool reset_view = false;
    bool follow = false;     // follow a person, or stop following
    std::size_t person = 0;  // person whose eyes to look through, from 1; 0: no change
    bool reset_scene = false;
    std::optional<NewObject> add;         // add this object before the eye
    std::optional<std::uint32_t> remove;  // remove this object
    bool remove_pointed = false;          // remove the selected object, or that under the pointer
    EditEvents edit;
    bool scan_models = false;   // read the list of models
    std::string measure_model;  // read the size of this model; empty: none
};

}  // namespace atrium::viewer
