#pragma once

#include "core/base/expected.hpp"

#include <array>
#include <memory>
#include <optional>
#include <string>

namespace atrium::test_support {

/// An X server without a screen (Xvfb) and without a window manager. Tests can look at windows on
/// it, resize them, and type into them. DISPLAY names it during its lifetime. Call it from one
/// thread. Windows are named by their titles, or what follows " - " in them; calls for an unknown
/// window do nothing.
class VirtualDisplay {
public:
    /// Starts a screen of this size [px]. Error kNotFound if Xvfb is not installed, kUnavailable if
    /// it does not start.
    static Expected<std::unique_ptr<VirtualDisplay>> start(int width, int height);
    ~VirtualDisplay();
    VirtualDisplay(const VirtualDisplay&) = delete;
    VirtualDisplay& operator=(const VirtualDisplay&) = delete;

    using Size = std::array<int, 2>;    // width, height [px]
    using Colour = std::array<int, 3>;  // red, green, blue, 0 to 255

    /// Empty if no window of that title is shown.
    std::optional<Size> size_of(const std::string& title);
    /// Colour on the screen at column `x` and row `y` of the window, from its upper left corner.
    std::optional<Colour> colour_in(const std::string& title, int x, int y);

    /// Also moves the window to the screen's upper left corner.
    void resize(const std::string& title, const Size& size);
    /// Presses a key by the X name of its symbol: "Escape", "F9", "h", "question".
    void press(const std::string& title, const std::string& key) { press(title, key, false); }
    void press_with_control(const std::string& title, const std::string& key) {
        press(title, key, true);
    }
    /// Presses a key without letting it go, or lets it go. `with_control`: as Ctrl is held.
    void hold_key(const std::string& title,
                  const std::string& key,
                  bool is_down,
                  bool with_control = false);
    /// Moves the mouse there, from the window's upper left corner.
    void point_at(const std::string& title, int x, int y);
    /// Presses the left button at the mouse, or releases it.
    void hold_button(const std::string& title, bool is_down);
    void press_escape(const std::string& title) { press(title, "Escape"); }
    /// Acts like the close button of a window's frame.
    void ask_to_close(const std::string& title);

private:
    void press(const std::string& title, const std::string& key, bool with_control) {
        hold_key(title, key, true, with_control);
        hold_key(title, key, false, with_control);  // a held key sends no second press
    }

    struct Impl;
    explicit VirtualDisplay(std::unique_ptr<Impl> impl);
    std::unique_ptr<Impl> impl_;
};

}  // namespace atrium::test_support
