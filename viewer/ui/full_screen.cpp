#include "viewer/ui/full_screen.hpp"

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

namespace atrium::viewer {

void FullScreen::toggle(GLFWwindow* window) {
    if (glfwGetWindowMonitor(window) != nullptr) {
        glfwSetWindowMonitor(
            window, nullptr, windowed_[0], windowed_[1], windowed_[2], windowed_[3], 0);
        return;
    }
    GLFWmonitor* monitor = glfwGetPrimaryMonitor();
    const GLFWvidmode* mode = monitor == nullptr ? nullptr : glfwGetVideoMode(monitor);
    if (mode == nullptr) return;
    glfwGetWindowPos(window, &windowed_[0], &windowed_[1]);
    glfwGetWindowSize(window, &windowed_[2], &windowed_[3]);
    glfwSetWindowMonitor(window, monitor, 0, 0, mode->width, mode->height, mode->refreshRate);
}

}  // namespace atrium::viewer
