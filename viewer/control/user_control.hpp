#pragma once

#include "core/bus/messages.hpp"
#include "viewer/control/follow_camera.hpp"
#include "viewer/control/mouse_grab.hpp"
#include "viewer/control/scene_editor.hpp"
#include "viewer/control/surface_events.hpp"
#include "viewer/control/view_flight.hpp"
#include "viewer/renderer/drawing/view_camera.hpp"

#include <chrono>
#include <string>
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
        : start_(start), camera_(start), is_fixed_(is_fixed), mouse_(sender), editor_(sender) {}

    const renderer::ViewCamera& camera() const { return camera_; }
    /// Person through whose eyes the user looks. Empty: nobody.
    std::string inside() const { return follow_.is_first_person() ? follow_.name() : ""; }

    /// Moves the viewpoint smoothly to `camera`. Mouse and keys end the flight.
    void fly_to(const renderer::ViewCamera& camera, Clock::time_point now);

    /// The world in the last picture.
    struct Shown {
        Pointer pointer;  // in the picture of one eye
        MouseGrab::Pick pick;
        FollowCamera::Places people;
        const SceneEditor::Objects& objects;
    };
    /// Moves the viewpoint, or the object that the mouse holds.
    Commands move(const SurfaceEvents& events, const Shown& shown, Clock::time_point now);
    /// Adds, removes and resets objects. `eye` is one of those that look from `camera`.
    Commands edit(const SurfaceEvents& events,
                  const Shown& shown,
                  const renderer::EyeView& eye,
                  Clock::time_point now);
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
    MouseGrab mouse_;
    SceneEditor editor_;
    FollowCamera follow_;
    ViewFlight flight_;
};

}  // namespace atrium::viewer
