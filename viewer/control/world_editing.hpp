#pragma once

#include "viewer/control/edit_events.hpp"
#include "viewer/control/edit_handles.hpp"
#include "viewer/control/edit_history.hpp"
#include "viewer/control/scene_editor.hpp"
#include "viewer/receive/edit_link.hpp"

#include <chrono>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace atrium::viewer {

/// What the picture and the panels show of the editing.
struct EditView {
    bool is_supported = false;  // the world server knows edits
    std::optional<bus::SceneObject> selected;
    geometry::RigidTransform pose{};  // of the selected object, as shown
    EditHandles handles{};
    std::optional<Handle> active;  // dragged, else under the pointer
    bool is_dragging = false;
    std::string readout;  // while dragging
    std::string undo;     // name of the object of the next undo; empty: none
    std::string redo;
    std::shared_ptr<const bus::SavedWorlds> worlds;  // null: no server has sent a list
};

/// Selects objects, drags their handles and builds the edits for the world server. Has no clock
/// and no bus. Drawing thread only.
class WorldEditing {
public:
    using Clock = std::chrono::steady_clock;
    using Edits = EditHistory::Edits;
    using Objects = SceneEditor::Objects;

    explicit WorldEditing(const std::string& sender) : history_(sender) {}

    /// The world in the last picture.
    struct Shown {
        Pointer pointer;  // in the picture of `eye`
        renderer::EyeView eye;
        std::function<std::optional<Hit>(const Ray&)> pick;  // fixed objects too
        const Objects& objects;
        const std::vector<bus::ObjectState>& states;
    };
    /// Handles pointer and keys. Returns edits to send.
    Edits update(const EditEvents& events, const Shown& shown, Clock::time_point now);
    /// True from a press on a handle to the release of the button: it moves neither viewpoint nor
    /// objects.
    bool has_pointer() const { return owns_press_; }

    Edits add(const bus::SceneObject& object, Clock::time_point now);
    /// Adds a copy of the selected object beside it, aside of what is `taken`, or says why not.
    Edits duplicate(const Shown& shown,
                    const std::vector<TakenPlace>& taken,
                    Clock::time_point now);
    /// The pose is where the object is shown.
    Edits remove(std::uint32_t object, const Shown& shown, Clock::time_point now);
    /// This viewer removes the object by a command: its user needs not be told.
    void expect_removal(std::uint32_t object) { commanded_ = object; }

    /// Takes news of the server; returns what the user should read.
    std::vector<std::string> take(EditNews news, Clock::time_point now);
    bool is_supported() const { return worlds_ != nullptr; }
    std::uint32_t selected() const { return selected_; }
    EditView view(const Shown& shown) const;

private:
    std::optional<EditHistory::Object> object_of(std::uint32_t id, const Shown& shown) const;
    EditHandles handles_of(const EditHistory::Object& object) const;
    void take_keys(const EditEvents& events, const Shown& shown, Clock::time_point now, Edits& out);
    void tell_removed(const Shown& shown, Clock::time_point now);
    void take_others(const std::vector<bus::EditResult>& results, Clock::time_point now);
    void take_refused_pulls(std::vector<bus::EditResult>& results);
    void select_by_click(const Shown& shown);
    void press(const Shown& shown, Clock::time_point now);
    void drag(const EditEvents& events, const Shown& shown, Clock::time_point now, Edits& out);
    void place(const PlaceWanted& wanted, const Shown& shown, Clock::time_point now, Edits& out);
    void hold_at_goal(Clock::time_point now, Edits& out);
    void cancel(Edits& out);

    EditHistory history_;
    std::shared_ptr<const bus::SavedWorlds> worlds_;
    std::uint32_t selected_ = 0;
    HandleMode mode_ = HandleMode::kMove;
    bool is_local_ = false;
    std::optional<Handle> hovered_;
    std::optional<HandleDrag> drag_;
    EditHistory::Object dragged_;    // when the drag began
    bool is_held_by_field_ = false;  // dragged by a number in its panel
    geometry::RigidTransform goal_{};
    geometry::RigidTransform sent_{};
    Clock::time_point sent_at_;
    bool was_down_ = false;
    bool lets_go_ = false;      // the drag has ended without a place
    bool owns_press_ = false;   // the button was pressed on a handle
    bool is_click_ = false;     // pressed, and not moved since
    bool is_pull_ = false;      // of the last press: it moved further than a click
    std::string refused_pull_;  // answer to the last press, not shown yet; empty: none
    Eigen::Vector2d pressed_px_ = Eigen::Vector2d::Zero();
    std::vector<std::string> texts_;
    struct Editor {
        std::string name;
        Clock::time_point at;
    };
    std::map<std::uint32_t, Editor> editors_;      // other viewers that edited an object last
    std::string selected_name_;                    // of the selected object when it was last seen
    std::uint32_t seen_ = 0;                       // selected object that was in the world
    std::optional<Clock::time_point> gone_since_;  // the selected object is
    std::uint32_t commanded_ = 0;
};

}  // namespace atrium::viewer
