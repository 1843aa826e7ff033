#pragma once

#include "core/base/expected.hpp"

#include <array>
#include <functional>
#include <memory>
#include <optional>
#include <string>

namespace atrium::test_support {

/// An X server without a screen (Xvfb), with no window manager on it: what a test opens there can
/// be looked at, resized, and typed into. While it lives, DISPLAY names it. Calls come from one
/// thread. Windows are named by their titles; nothing happens where there is no such window.
class VirtualDisplay {
public:
    /// Its screen in pixels. Error kNotFound where Xvfb is not installed, kUnavailable where it
    /// does not start.
    static Expected<std::unique_ptr<VirtualDisplay>> start(int width, int height);
    ~VirtualDisplay();
    VirtualDisplay(const VirtualDisplay&) = delete;
    VirtualDisplay& operator=(const VirtualDisplay&) = delete;

    using Size = std::array<int, 2>;    // width, height [px]
    using Colour = std::array<int, 3>;  // red, green, blue, 0 to 255

    /// None where no window of that title is shown.
    std::optional<Size> size_of(const std::string& title);
    /// Of what the screen shows at column `x` and row `y` of that window, from its upper left
    /// corner.
    std::optional<Colour> colour_in(const std::string& title, int x, int y);

    /// Moves it into the screen's upper left corner as well.
    void resize(const std::string& title, const Size& size);
    /// A key by X's name of what it types: "Escape", "F9", "h", "question".
    void press(const std::string& title, const std::string& key);
    /// Puts the mouse there, from the window's upper left corner.
    void point_at(const std::string& title, int x, int y);
    /// Presses the left button where the mouse is, or lets it go.
    void hold_button(const std::string& title, bool is_down);
    void press_escape(const std::string& title) { press(title, "Escape"); }
    /// As the button in a window's frame does.
    void ask_to_close(const std::string& title);

private:
    struct Impl;
    explicit VirtualDisplay(std::unique_ptr<Impl> impl);
    std::unique_ptr<Impl> impl_;
};

/// Looks again and again until it is true. False: it did not come true in a minute.
bool comes_true(const std::function<bool()>& condition);

}  // namespace atrium::test_support
