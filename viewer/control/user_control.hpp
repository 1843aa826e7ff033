#pragma once

#include "core/bus/messages.hpp"
#include "viewer/control/follow_camera.hpp"
#include "viewer/control/mouse_grab.hpp"
#include "viewer/control/scene_editor.hpp"
#include "viewer/control/surface_events.hpp"
#include "viewer/control/view_flight.hpp"
#include "viewer/control/world_editing.hpp"
#include "viewer/renderer/drawing/view_camera.hpp"

#include <chrono>
#include <string>
#include <utility>
#include <vector>

namespace atrium::viewer {

/// Moves the viewpoint and edits the world as the user asks. Has no clock and no bus: the caller
/// passes all times and sends the commands. Not thread-safe.
class UserControl {
public:
    using Clock = std::chrono::steady_clock;
    using Commands = std::vector<bus::SceneCommand>;

    /// `sender` is in all commands. `is_fixed`: ignores motion and pointer, as on a tile of a wall.
    UserControl(const renderer::ViewCamera& start, const std::string& sender, bool is_fixed)
        : start_(start),
          camera_(start),
          is_fixed_(is_fixed),
          mouse_(sender),
          editor_(sender),
          editing_(sender) {}

    const renderer::ViewCamera& camera() const { return camera_; }
    /// Person through whose eyes the user looks. Empty: nobody.
    std::string inside() const { return follow_.is_first_person() ? follow_.name() : ""; }
    /// Person whom the viewpoint follows from outside. Empty: nobody.
    std::string followed() const { return follow_.is_first_person() ? "" : follow_.name(); }

    /// Replaces the viewpoint of the start, to which V returns; goes there if the user has not
    /// moved.
    void set_start(const renderer::ViewCamera& start);
    /// Moves the viewpoint smoothly to `camera`. Mouse and keys end the flight.
    void fly_to(const renderer::ViewCamera& camera, Clock::time_point now);

    /// The world in the last picture.
    struct Shown {
        Pointer pointer;  // in the picture of one eye
        MouseGrab::Pick pick;
        FollowCamera::Places people;
        const SceneEditor::Objects& objects;
        MouseGrab::Pick pick_all;  // fixed objects too
        const std::vector<bus::ObjectState>& states;
        renderer::EyeView eye;              // the eye whose picture is under the pointer
        FollowCamera::Places visible = {};  // those of `people` that the user does not hide
    };
    /// Moves the viewpoint, or the object that the mouse holds.
    Commands move(const SurfaceEvents& events, const Shown& shown, Clock::time_point now);
    /// Adds, removes and resets objects. `eye` is one of those that look from `camera`.
    Commands edit(const SurfaceEvents& events,
                  const Shown& shown,
                  const renderer::EyeView& eye,
                  Clock::time_point now);
    /// Takes the edits for the world server since the last call.
    WorldEditing::Edits take_edits() { return std::exchange(edits_, {}); }
    /// Takes news about edits; returns what the user should read, also about keys without an
    /// effect.
    std::vector<std::string> take(EditNews news, Clock::time_point now) {
        std::vector<std::string> texts = editing_.take(std::move(news), now);
        texts.insert(texts.end(), texts_.begin(), texts_.end());
        texts_.clear();
        return texts;
    }
    EditView edit_view(const Shown& shown) const { return editing_.view(edit_shown(shown)); }
    /// Outcomes of the edits, see SceneEditor.
    std::vector<SceneEditor::Outcome> outcomes(const SceneEditor::Objects& objects,
                                               const SceneEditor::Servers& servers,
                                               Clock::time_point now) {
        return editor_.outcomes(objects, servers, now);
    }

private:
    renderer::ViewCamera start_;
    renderer::ViewCamera camera_;
    bool is_fixed_;
    bool has_moved_ = false;  // the user chose another viewpoint than that of the start
    MouseGrab mouse_;
    static WorldEditing::Shown edit_shown(const Shown& shown);
    void remove(std::uint32_t object, const Shown& shown, Clock::time_point now, Commands& out);

    SceneEditor editor_;
    WorldEditing editing_;
    WorldEditing::Edits edits_;
    std::vector<std::string> texts_;  // answers to keys without an effect
    FollowCamera follow_;
    ViewFlight flight_;
};

}  // namespace atrium::viewer
