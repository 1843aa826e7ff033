#pragma once

#include <array>

struct GLFWwindow;

namespace atrium::viewer {

/// Switches a window between full screen and its place before.
class FullScreen {
public:
    void toggle(GLFWwindow* window);

private:
    std::array<int, 4> windowed_{};  // position and size before full screen
};

}  // namespace atrium::viewer
