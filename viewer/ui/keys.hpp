#pragma once

#include "viewer/control/surface_events.hpp"

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

namespace atrium::viewer {

/// What the user asks for with a key.
enum class Action : std::uint8_t {
    kMove,  // while the keys are held
    kWalk,
    kEyes,
    kFollow,
    kStartView,
    kStoreView,
    kGoToView,
    kPreviousView,
    kNextView,
    kViews,
    kSites,
    kPreviousSite,
    kNextSite,
    kHideSite,
    kSoloSite,
    kHandles,
    kLocalAxes,
    kAxis,
    kDuplicate,
    kUndo,
    kRedo,
    kNames,
    kMenu,
    kSavedWorlds,
    kRemovePointed,
    kDebug,
    kReset,
    kFullScreen,
    kScreenshot,
    kVideo,
    kStream,
    kDetails,
    kPanel,
    kKeys,
    kPlay,
    kFrameBack,
    kFrameOn,
    kTimeBack,
    kTimeOn,
    kSlower,
    kFaster,
    kMarkIn,
    kMarkOut,
    kKeepView,
    kOtherWorld,
    kClose,
    kMouse,  // not a key: lines about the mouse in the list of keys
};

/// A line of the list of keys, and the keys themselves. The window binds what this table has, and
/// nothing else.
struct KeyBinding {
    Action action;
    std::string_view shown;  // as the user reads it
    std::string_view what;
    bool with_control = false;
    bool with_shift = false;
    std::array<int, 9> keys{};    // GLFW's numbers; 0: none
    bool while_dragging = false;  // only while the mouse drags a handle of an object
};

std::span<const KeyBinding> key_bindings();

struct PressedKey {
    Action action;
    int number = 0;  // place of the key in its binding, from 1
};
/// The binding of a key with GLFW's modifiers. Empty: the key is not bound. Keys without
/// modifiers in the table work with Shift too. While the mouse drags a handle, its keys come first,
/// with Ctrl too, which then means steps.
std::optional<PressedKey> find_key(int key, int modifiers, bool is_dragging = false);

/// The key whose letter the user means. Ctrl+Z and the axes X, Y, Z are meant by letter, where
/// other keys are meant by place: German keyboards have Y and Z the other way round.
int key_of_letter(int key);

/// Notes a key for the view. Returns false for the others.
bool change_view(const PressedKey& key, SurfaceEvents& events);

/// Notes a key for the recording that is shown. Returns false for the others.
bool change_playback(const PressedKey& key, SurfaceEvents& events);

/// Notes a key for selected objects. Returns false for the others.
bool change_selected(const PressedKey& key, EditEvents& edit);

}  // namespace atrium::viewer
