#pragma once

#include "core/bus/messages.hpp"

#include <cstdint>
#include <optional>
#include <string>

namespace atrium::viewer {

/// A model file to add to the world.
struct NewModel {
    std::string file;  // in the folder of models
    double scale = 1.0;
    bool is_compound = false;  // one hull per part of the file, else one around everything
    double mass_kg = 1.0;      // 0: fixed
    Eigen::Vector3d size_m = Eigen::Vector3d::Ones();  // as far as known
    std::optional<Eigen::Vector3d> colour{};  // of its file, linear RGB; none: the usual grey
};

/// A pose that the user types, or drags a number of.
struct PlaceWanted {
    std::uint32_t object = 0;
    geometry::RigidTransform world_from_object{};
    bool is_held = false;  // the field is still dragged
};

/// What the user asks to edit.
struct EditEvents {
    bool is_enabled = true;     // false: the picture shows no handles and a click selects nothing
    bool next_handles = false;  // arrows, then rings
    bool local_axes = false;    // switch between the axes of the object and those of the world
    bool snaps = false;         // while true, in steps of 10 cm or 15 degrees
    std::optional<int> axis;    // 0, 1, 2: only along or about this axis
    bool duplicate = false;     // the selected object
    bool undo = false;
    bool redo = false;
    bool cancel = false;                     // ends the drag, then the selection
    std::optional<std::uint32_t> select;     // 0: nothing
    std::optional<bus::SceneObject> change;  // new properties of the object of that number
    std::optional<PlaceWanted> place;
    std::optional<NewModel> add_model;
    std::string save_world;  // name; empty: none
    std::string load_world;
    std::string hint;  // why the panel did not take a value; empty: none
};

}  // namespace atrium::viewer
