#include "viewer/ui/full_screen.hpp"

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

namespace atrium::viewer {
namespace {

// The monitor that shows the middle of the window, else the primary one.
GLFWmonitor* monitor_of(GLFWwindow* window) {
    int x = 0, y = 0, width = 0, height = 0;
    glfwGetWindowPos(window, &x, &y);
    glfwGetWindowSize(window, &width, &height);
    int num_monitors = 0;
    GLFWmonitor** const monitors = glfwGetMonitors(&num_monitors);
    for (int i = 0; i < num_monitors; ++i) {
        int left = 0, top = 0;
        glfwGetMonitorPos(monitors[i], &left, &top);
        const GLFWvidmode* mode = glfwGetVideoMode(monitors[i]);
        if (mode == nullptr) continue;
        const int from_left = x + width / 2 - left;
        const int from_top = y + height / 2 - top;
        if (from_left >= 0 && from_left < mode->width && from_top >= 0 && from_top < mode->height)
            return monitors[i];
    }
    return glfwGetPrimaryMonitor();
}

}  // namespace

void FullScreen::toggle(GLFWwindow* window) {
    if (glfwGetWindowMonitor(window) != nullptr) {
        glfwSetWindowMonitor(
            window, nullptr, windowed_[0], windowed_[1], windowed_[2], windowed_[3], 0);
        return;
    }
    GLFWmonitor* monitor = monitor_of(window);
    const GLFWvidmode* mode = monitor == nullptr ? nullptr : glfwGetVideoMode(monitor);
    if (mode == nullptr) return;
    // a projector must go on showing while somebody works on another monitor
    glfwSetWindowAttrib(window, GLFW_AUTO_ICONIFY, GLFW_FALSE);
    glfwGetWindowPos(window, &windowed_[0], &windowed_[1]);
    glfwGetWindowSize(window, &windowed_[2], &windowed_[3]);
    glfwSetWindowMonitor(window, monitor, 0, 0, mode->width, mode->height, mode->refreshRate);
}

}  // namespace atrium::viewer
