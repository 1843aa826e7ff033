#pragma once

#include "viewer/control/controls.hpp"
#include "viewer/control/edit_events.hpp"
#include "viewer/control/mouse_grab.hpp"
#include "viewer/control/playback_events.hpp"
#include "viewer/control/scene_editor.hpp"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace atrium::viewer {

/// What to do with a numbered viewpoint.
struct ViewpointEvent {
    enum class Kind : std::uint8_t { kKeep, kGo, kGoNext, kGoPrevious, kRename, kForget };
    Kind kind = Kind::kGo;
    int number = 0;    // from 1; without meaning for the next and the previous one
    std::string name;  // kRename
};

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
    bool follow = false;      // follow a person, or stop following
    std::size_t person = 0;   // person whose eyes to look through, from 1; 0: no change
    bool leave_eyes = false;  // look from outside again
    bool stop_following = false;
    std::optional<ViewpointEvent> viewpoint;
    std::string hide_site;  // hide this site, or show it again; empty: none
    std::string solo_site;  // show only this site, or all again; empty: none
    std::vector<PlaybackEvent> playback;
    bool other_world = false;  // leave the world for the list of worlds
    bool reset_scene = false;
    std::optional<NewObject> add;         // add this object before the eye
    std::optional<std::uint32_t> remove;  // remove this object
    bool remove_pointed = false;          // remove the selected object, or that under the pointer
    bool is_over_panel = false;           // with `remove_pointed`: no object is under the pointer
    EditEvents edit;
    bool show_models = false;   // the list of models is open
    std::string measure_model;  // read the size of this model; empty: none
};

}  // namespace atrium::viewer
