#include "site_node/preview/preview_window.hpp"

#include "core/gl/entry_points.hpp"

#include <glad/gl.h>
// after the loader, in place of GLFW's own GL header
#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

#include <algorithm>
#include <cstdlib>

namespace atrium::preview {
namespace {

constexpr int kFirstWidth = 960;
constexpr int kFirstHeight = 540;

constexpr double kOfScreen = 0.9;  // leaves room for the window's frame

// Makes the window as large as the picture, or smaller if the screen is.
void fit_window(GLFWwindow* window, int width, int height) {
    double scale = 1.0;
    int x = 0, y = 0, screen_width = 0, screen_height = 0;
    if (GLFWmonitor* monitor = glfwGetPrimaryMonitor(); monitor != nullptr)
        glfwGetMonitorWorkarea(monitor, &x, &y, &screen_width, &screen_height);
    if (screen_width > 0 && screen_height > 0)
        scale =
            std::min({1.0, kOfScreen * screen_width / width, kOfScreen * screen_height / height});
    glfwSetWindowSize(window,
                      std::max(1, static_cast<int>(scale * width)),
                      std::max(1, static_cast<int>(scale * height)));
}

std::string last_error() {
    const char* text = nullptr;
    glfwGetError(&text);
    return text == nullptr ? "unknown reason" : text;
}

}  // namespace

struct PreviewWindow::Impl {
    GLFWwindow* window = nullptr;
    GLuint texture = 0;
    GLuint framebuffer = 0;  // around the texture, to copy from
    int width = 0;
    int height = 0;

    Impl() = default;
    Impl(const Impl&) = delete;
    Impl& operator=(const Impl&) = delete;
    ~Impl() {
        if (framebuffer != 0) glDeleteFramebuffers(1, &framebuffer);
        if (texture != 0) glDeleteTextures(1, &texture);
        if (window != nullptr) glfwDestroyWindow(window);
        glfwTerminate();
    }

    void make_target() {
        glGenTextures(1, &texture);
        glGenFramebuffers(1, &framebuffer);
    }

    void resize(const Picture& picture) {
        if (width == 0) fit_window(window, picture.width, picture.height);
        width = picture.width;
        height = picture.height;
        glTexImage2D(
            GL_TEXTURE_2D, 0, GL_RGB8, width, height, 0, GL_BGR, GL_UNSIGNED_BYTE, nullptr);
        glBindFramebuffer(GL_READ_FRAMEBUFFER, framebuffer);
        glFramebufferTexture2D(
            GL_READ_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, texture, 0);
    }

    // Scales to the largest size that fits, centred.
    void copy_to_window() const {
        int window_width = 0;
        int window_height = 0;
        glfwGetFramebufferSize(window, &window_width, &window_height);
        const double scale = std::min(static_cast<double>(window_width) / width,
                                      static_cast<double>(window_height) / height);
        const int shown_width = static_cast<int>(scale * width);
        const int shown_height = static_cast<int>(scale * height);
        const int x = (window_width - shown_width) / 2;
        const int y = (window_height - shown_height) / 2;
        glBindFramebuffer(GL_DRAW_FRAMEBUFFER, 0);
        glClear(GL_COLOR_BUFFER_BIT);
        glBindFramebuffer(GL_READ_FRAMEBUFFER, framebuffer);
        // upside down: rows of pictures run from the top
        glBlitFramebuffer(0,
                          0,
                          width,
                          height,
                          x,
                          y + shown_height,
                          x + shown_width,
                          y,
                          GL_COLOR_BUFFER_BIT,
                          GL_LINEAR);
        glfwSwapBuffers(window);
    }
};

PreviewWindow::PreviewWindow(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
PreviewWindow::~PreviewWindow() = default;

Expected<std::unique_ptr<PreviewWindow>> PreviewWindow::open(const std::string& title) {
    const auto failed = [](const std::string& why) {
        return make_error(ErrorKind::kUnavailable, "preview window: " + why);
    };
    if (std::getenv("DISPLAY") == nullptr) return failed("DISPLAY is not set");
    if (glfwInit() == GLFW_FALSE) return failed(last_error());
    auto impl = std::make_unique<Impl>();
    glfwWindowHint(GLFW_CONTEXT_VERSION_MAJOR, 3);
    glfwWindowHint(GLFW_CONTEXT_VERSION_MINOR, 3);
    glfwWindowHint(GLFW_OPENGL_PROFILE, GLFW_OPENGL_CORE_PROFILE);
    impl->window = glfwCreateWindow(kFirstWidth, kFirstHeight, title.c_str(), nullptr, nullptr);
    if (impl->window == nullptr) return failed(last_error());
    // also reports a key pressed and released between two polls
    glfwSetInputMode(impl->window, GLFW_STICKY_KEYS, GLFW_TRUE);
    glfwMakeContextCurrent(impl->window);
    if (auto loaded = gl::load_entry_points(&glfwGetProcAddress); !loaded)
        return tl::unexpected(loaded.error());
    glfwSwapInterval(0);
    impl->make_target();
    return std::unique_ptr<PreviewWindow>(new PreviewWindow(std::move(impl)));
}

void PreviewWindow::show(const Picture& picture) {
    glBindTexture(GL_TEXTURE_2D, impl_->texture);
    glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
    if (picture.width != impl_->width || picture.height != impl_->height) impl_->resize(picture);
    glTexSubImage2D(GL_TEXTURE_2D,
                    0,
                    0,
                    0,
                    picture.width,
                    picture.height,
                    GL_BGR,
                    GL_UNSIGNED_BYTE,
                    picture.bgr.data());
    impl_->copy_to_window();
}

bool PreviewWindow::stays_open() {
    glfwPollEvents();
    return glfwWindowShouldClose(impl_->window) == GLFW_FALSE &&
           glfwGetKey(impl_->window, GLFW_KEY_ESCAPE) != GLFW_PRESS;
}

}  // namespace atrium::preview
