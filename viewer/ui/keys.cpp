#include "viewer/ui/keys.hpp"

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

#include <algorithm>

namespace atrium::viewer {
namespace {

constexpr std::array<int, 9> kDigits{GLFW_KEY_1,
                                     GLFW_KEY_2,
                                     GLFW_KEY_3,
                                     GLFW_KEY_4,
                                     GLFW_KEY_5,
                                     GLFW_KEY_6,
                                     GLFW_KEY_7,
                                     GLFW_KEY_8,
                                     GLFW_KEY_9};
constexpr bool kControl = true;
constexpr bool kShift = true;

constexpr std::array kBindings{
    KeyBinding{Action::kMouse, "drag left, on an object", "pull it; release to throw it"},
    KeyBinding{Action::kMouse, "click an object", "select it; its panel edits it"},
    KeyBinding{Action::kMouse,
               "drag an arrow or a ring",
               "move or rotate the selected object; with Ctrl in steps"},
    KeyBinding{Action::kMouse, "drag left elsewhere", "orbit around the target"},
    KeyBinding{Action::kMouse, "Shift and drag left", "look around"},
    KeyBinding{Action::kMouse, "drag right, wheel", "pan, zoom"},
    KeyBinding{Action::kMove,
               "W A S D, Q E",
               "fly; down, up",
               false,
               false,
               {GLFW_KEY_W, GLFW_KEY_A, GLFW_KEY_S, GLFW_KEY_D, GLFW_KEY_Q, GLFW_KEY_E}},
    KeyBinding{Action::kWalk, "G", "walk on the floor, or fly again", false, false, {GLFW_KEY_G}},
    KeyBinding{Action::kEyes,
               "1 ... 9",
               "look through the eyes of that person; again: leave",
               false,
               false,
               kDigits},
    KeyBinding{Action::kFollow,
               "F",
               "follow the shown person nearest to the target, or stop",
               false,
               false,
               {GLFW_KEY_F}},
    KeyBinding{
        Action::kStartView, "V", "return to the first viewpoint", false, false, {GLFW_KEY_V}},
    KeyBinding{Action::kStoreView,
               "Ctrl+1 ... 9",
               "keep this viewpoint under that number",
               kControl,
               false,
               kDigits},
    KeyBinding{Action::kGoToView, "Shift+1 ... 9", "fly to that viewpoint", false, kShift, kDigits},
    KeyBinding{Action::kPreviousView,
               "Page Up",
               "fly to the previous viewpoint",
               false,
               false,
               {GLFW_KEY_PAGE_UP}},
    KeyBinding{Action::kNextView,
               "Page Down",
               "fly to the next viewpoint",
               false,
               false,
               {GLFW_KEY_PAGE_DOWN}},
    KeyBinding{
        Action::kViews, "K", "list of viewpoints: names, go, delete", false, false, {GLFW_KEY_K}},
    KeyBinding{Action::kSites, "L", "list of sites: hide, solo", false, false, {GLFW_KEY_L}},
    KeyBinding{Action::kPreviousSite,
               "Up",
               "choose the previous site of the list",
               false,
               false,
               {GLFW_KEY_UP}},
    KeyBinding{Action::kNextSite,
               "Down",
               "choose the next site of the list",
               false,
               false,
               {GLFW_KEY_DOWN}},
    KeyBinding{Action::kHideSite,
               "X",
               "hide the site chosen in the list, or show it",
               false,
               false,
               {GLFW_KEY_X}},
    KeyBinding{Action::kSoloSite,
               "O",
               "only the site chosen in the list, or as before",
               false,
               false,
               {GLFW_KEY_O}},
    KeyBinding{Action::kHandles,
               "J",
               "arrows or rings at the selected object",
               false,
               false,
               {GLFW_KEY_J}},
    KeyBinding{Action::kLocalAxes,
               "C",
               "axes of the world, or of the selected object",
               false,
               false,
               {GLFW_KEY_C}},
    KeyBinding{Action::kAxis,
               "X, Y, Z while dragging",
               "only along or about this axis",
               false,
               false,
               {GLFW_KEY_X, GLFW_KEY_Y, GLFW_KEY_Z},
               true},
    KeyBinding{Action::kDuplicate,
               "Ctrl+D",
               "duplicate the selected object",
               kControl,
               false,
               {GLFW_KEY_D}},
    KeyBinding{Action::kUndo, "Ctrl+Z", "undo the last edit", kControl, false, {GLFW_KEY_Z}},
    KeyBinding{Action::kRedo, "Ctrl+Shift+Z", "redo it", kControl, kShift, {GLFW_KEY_Z}},
    KeyBinding{Action::kRedo, "Ctrl+Y", "redo it", kControl, false, {GLFW_KEY_Y}},
    KeyBinding{Action::kNames, "N", "show or hide the names of people", false, false, {GLFW_KEY_N}},
    KeyBinding{Action::kMenu,
               "M",
               "menu: add objects and models, save and load worlds",
               false,
               false,
               {GLFW_KEY_M}},
    KeyBinding{
        Action::kSavedWorlds, "Ctrl+S", "menu, at the saved worlds", kControl, false, {GLFW_KEY_S}},
    KeyBinding{Action::kRemovePointed,
               "Delete",
               "remove the selected object, else the one under the mouse",
               false,
               false,
               {GLFW_KEY_DELETE}},
    KeyBinding{Action::kDebug,
               "B",
               "debug view: wireframe, silhouettes, collision shapes",
               false,
               false,
               {GLFW_KEY_B}},
    KeyBinding{
        Action::kReset, "R", "twice: reset all objects, for everybody", false, false, {GLFW_KEY_R}},
    KeyBinding{Action::kFullScreen, "F11", "full screen on or off", false, false, {GLFW_KEY_F11}},
    KeyBinding{
        Action::kScreenshot, "F12, P", "screenshot", false, false, {GLFW_KEY_F12, GLFW_KEY_P}},
    KeyBinding{Action::kVideo, "F9", "start or stop a video", false, false, {GLFW_KEY_F9}},
    KeyBinding{Action::kStream,
               "F10",
               "start or stop the stream and the virtual camera",
               false,
               false,
               {GLFW_KEY_F10}},
    KeyBinding{
        Action::kDetails, "T", "show or hide graphs and stage times", false, false, {GLFW_KEY_T}},
    KeyBinding{Action::kPanel, "H", "show or hide the panel", false, false, {GLFW_KEY_H}},
    KeyBinding{Action::kKeys, "F1, ?", "show or hide this list", false, false, {GLFW_KEY_F1}},
    KeyBinding{Action::kPlay, "Space", "recording: play or pause", false, false, {GLFW_KEY_SPACE}},
    KeyBinding{
        Action::kFrameBack, ",", "recording: one frame back", false, false, {GLFW_KEY_COMMA}},
    KeyBinding{Action::kFrameOn, ".", "recording: one frame on", false, false, {GLFW_KEY_PERIOD}},
    KeyBinding{Action::kTimeBack, "Left", "recording: 1 s back", false, false, {GLFW_KEY_LEFT}},
    KeyBinding{Action::kTimeOn, "Right", "recording: 1 s on", false, false, {GLFW_KEY_RIGHT}},
    KeyBinding{Action::kSlower,
               "-",
               "recording: half the speed",
               false,
               false,
               {GLFW_KEY_MINUS, GLFW_KEY_KP_SUBTRACT}},
    KeyBinding{Action::kFaster,
               "+",
               "recording: twice the speed",
               false,
               false,
               {GLFW_KEY_EQUAL, GLFW_KEY_KP_ADD}},
    KeyBinding{
        Action::kMarkIn, "[", "recording: begin here", false, false, {GLFW_KEY_LEFT_BRACKET}},
    KeyBinding{
        Action::kMarkOut, "]", "recording: end here", false, false, {GLFW_KEY_RIGHT_BRACKET}},
    KeyBinding{Action::kKeepView,
               "U",
               "recording: keep this viewpoint for the camera path",
               false,
               false,
               {GLFW_KEY_U}},
    KeyBinding{Action::kOtherWorld,
               "Backspace",
               "leave this world, back to the list of worlds (twice while an object is selected)",
               false,
               false,
               {GLFW_KEY_BACKSPACE}},
    KeyBinding{Action::kClose,
               "Esc",
               "end the question, drag, last panel, selection, following, eyes; twice: quit",
               false,
               false,
               {GLFW_KEY_ESCAPE}},
};

}  // namespace

std::span<const KeyBinding> key_bindings() { return kBindings; }

std::optional<PressedKey> find_key(int key, int modifiers, bool is_dragging) {
    const bool has_control = (modifiers & GLFW_MOD_CONTROL) != 0;
    const bool has_shift = (modifiers & GLFW_MOD_SHIFT) != 0;
    std::optional<PressedKey> without_shift;
    std::optional<PressedKey> exact;
    if (key <= 0) return without_shift;
    for (const KeyBinding& binding : kBindings) {
        const auto found = std::find(binding.keys.begin(), binding.keys.end(), key);
        if (found == binding.keys.end()) continue;
        const PressedKey pressed{binding.action,
                                 static_cast<int>(found - binding.keys.begin()) + 1};
        if (binding.while_dragging) {
            if (is_dragging) return pressed;
            continue;
        }
        if (binding.with_control != has_control) continue;
        if (binding.with_shift == has_shift && !exact) exact = pressed;
        if (!binding.with_shift) without_shift = pressed;
    }
    return exact ? exact : without_shift;
}

int key_of_letter(int key) {
    const char* name = glfwGetKeyName(key, 0);
    const bool is_letter = name != nullptr && name[0] >= 'a' && name[0] <= 'z' && name[1] == '\0';
    return is_letter ? GLFW_KEY_A + (name[0] - 'a') : key;
}

bool change_view(const PressedKey& key, SurfaceEvents& events) {
    using Kind = ViewpointEvent::Kind;
    const auto go = [&](Kind kind) { events.viewpoint = ViewpointEvent{kind, key.number, ""}; };
    switch (key.action) {
        case Action::kScreenshot:
            events.screenshot = true;
            return true;
        case Action::kReset:
            events.reset_scene = true;
            return true;
        case Action::kStartView:
            events.reset_view = true;
            return true;
        case Action::kVideo:
            events.record = true;
            return true;
        case Action::kStream:
            events.stream = true;
            return true;
        case Action::kFollow:
            events.follow = true;
            return true;
        case Action::kEyes:
            events.person = static_cast<std::size_t>(key.number);
            return true;
        case Action::kStoreView:
            go(Kind::kKeep);
            return true;
        case Action::kGoToView:
            go(Kind::kGo);
            return true;
        case Action::kPreviousView:
            go(Kind::kGoPrevious);
            return true;
        case Action::kNextView:
            go(Kind::kGoNext);
            return true;
        case Action::kNames:
            events.names = true;
            return true;
        case Action::kDebug:
            events.debug = true;
            return true;
        case Action::kOtherWorld:
            events.other_world = true;
            return true;
        case Action::kMove:
            return true;  // polled by the window
        default:
            return false;
    }
}

bool change_playback(const PressedKey& key, SurfaceEvents& events) {
    using Kind = PlaybackEvent::Kind;
    constexpr std::chrono::seconds kJump{1};
    const auto want = [&](PlaybackEvent event) {
        events.playback.push_back(event);
        return true;
    };
    switch (key.action) {
        case Action::kPlay:
            return want({.kind = Kind::kToggle});
        case Action::kFrameBack:
            return want({.kind = Kind::kStep, .number = -1});
        case Action::kFrameOn:
            return want({.kind = Kind::kStep, .number = 1});
        case Action::kTimeBack:
            return want({.kind = Kind::kSeekBy, .time = -kJump});
        case Action::kTimeOn:
            return want({.kind = Kind::kSeekBy, .time = kJump});
        case Action::kSlower:
            return want({.kind = Kind::kSpeedBy, .factor = 0.5});
        case Action::kFaster:
            return want({.kind = Kind::kSpeedBy, .factor = 2.0});
        case Action::kMarkIn:
            return want({.kind = Kind::kMarkIn});
        case Action::kMarkOut:
            return want({.kind = Kind::kMarkOut});
        case Action::kKeepView:
            return want({.kind = Kind::kKeepView});
        default:
            return false;
    }
}

bool change_selected(const PressedKey& key, EditEvents& edit) {
    switch (key.action) {
        case Action::kHandles:
            edit.next_handles = true;
            return true;
        case Action::kLocalAxes:
            edit.local_axes = true;
            return true;
        case Action::kAxis:
            edit.axis = key.number - 1;
            return true;
        case Action::kDuplicate:
            edit.duplicate = true;
            return true;
        case Action::kUndo:
            edit.undo = true;
            return true;
        case Action::kRedo:
            edit.redo = true;
            return true;
        default:
            return false;
    }
}

}  // namespace atrium::viewer
