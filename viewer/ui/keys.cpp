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
    KeyBinding{
        Action::kFollow, "F", "follow the nearest person, or stop", false, false, {GLFW_KEY_F}},
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
    KeyBinding{
        Action::kHideSite, "X", "hide the chosen site, or show it", false, false, {GLFW_KEY_X}},
    KeyBinding{
        Action::kSoloSite, "O", "only the chosen site, or all again", false, false, {GLFW_KEY_O}},
    KeyBinding{Action::kNames, "N", "show or hide the names of people", false, false, {GLFW_KEY_N}},
    KeyBinding{Action::kMenu, "M", "menu: add and remove objects", false, false, {GLFW_KEY_M}},
    KeyBinding{Action::kRemovePointed,
               "Delete",
               "remove the object under the mouse",
               false,
               false,
               {GLFW_KEY_DELETE}},
    KeyBinding{Action::kDebug,
               "B",
               "debug view: wireframe, silhouettes, collision shapes",
               false,
               false,
               {GLFW_KEY_B}},
    KeyBinding{Action::kReset, "R", "reset all objects", false, false, {GLFW_KEY_R}},
    KeyBinding{Action::kFullScreen, "F11", "full screen on or off", false, false, {GLFW_KEY_F11}},
    KeyBinding{
        Action::kScreenshot, "F12, P", "screenshot", false, false, {GLFW_KEY_F12, GLFW_KEY_P}},
    KeyBinding{Action::kVideo, "F9", "start or stop a video", false, false, {GLFW_KEY_F9}},
    KeyBinding{
        Action::kDetails, "T", "show or hide graphs and stage times", false, false, {GLFW_KEY_T}},
    KeyBinding{Action::kPanel, "H", "show or hide the panel", false, false, {GLFW_KEY_H}},
    KeyBinding{Action::kKeys, "F1, ?", "show or hide this list", false, false, {GLFW_KEY_F1}},
    KeyBinding{Action::kOtherWorld,
               "Backspace",
               "leave this world, back to the list of worlds",
               false,
               false,
               {GLFW_KEY_BACKSPACE}},
    KeyBinding{Action::kClose,
               "Esc",
               "close what is open, at last the window",
               false,
               false,
               {GLFW_KEY_ESCAPE}},
};

}  // namespace

std::span<const KeyBinding> key_bindings() { return kBindings; }

std::optional<PressedKey> find_key(int key, int modifiers) {
    const bool has_control = (modifiers & GLFW_MOD_CONTROL) != 0;
    const bool has_shift = (modifiers & GLFW_MOD_SHIFT) != 0;
    std::optional<PressedKey> without_shift;
    if (key <= 0) return without_shift;
    for (const KeyBinding& binding : kBindings) {
        const auto found = std::find(binding.keys.begin(), binding.keys.end(), key);
        if (found == binding.keys.end() || binding.with_control != has_control) continue;
        const PressedKey pressed{binding.action,
                                 static_cast<int>(found - binding.keys.begin()) + 1};
        if (binding.with_shift == has_shift) return pressed;
        if (!binding.with_shift) without_shift = pressed;
    }
    return without_shift;
}

}  // namespace atrium::viewer
