#include "core/gl/entry_points.hpp"
#include "viewer/ui/edit_panel.hpp"
#include "viewer/ui/hud.hpp"
#include "viewer/ui/menu.hpp"
#include "viewer/ui/surface.hpp"

#include <glad/gl.h>
// after the loader, instead of GLFW's own GL header
#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>
#include <imgui.h>
#include <imgui_impl_glfw.h>
#include <imgui_impl_opengl3.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdlib>
#include <utility>

namespace atrium::viewer {
namespace {

std::string last_glfw_error() {
    const char* text = nullptr;
    glfwGetError(&text);
    return text == nullptr ? "unknown reason" : text;
}

class Window : public Surface {
public:
    Window(GLFWwindow* window, const SurfaceOptions& options)
        : window_(window), has_two_buffers_(options.has_two_buffers) {
        glfwSetWindowUserPointer(window_, this);
        glfwSetKeyCallback(window_, [](GLFWwindow* w, int key, int, int action, int) {
            if (action == GLFW_PRESS)
                static_cast<Window*>(glfwGetWindowUserPointer(w))->pressed(key);
        });
        glfwSetCharCallback(window_, [](GLFWwindow* w, unsigned character) {
            static_cast<Window*>(glfwGetWindowUserPointer(w))->typed(character);
        });
        glfwSetScrollCallback(window_, [](GLFWwindow* w, double, double steps) {
            if (ImGui::GetIO().WantCaptureMouse) return;
            static_cast<Window*>(glfwGetWindowUserPointer(w))->events_.motion.zoom_steps += steps;
        });
        // ImGui keeps its context in a global: only one window at a time
        ImGui::CreateContext();
        ImGui::GetIO().IniFilename = nullptr;
        // ImGui chains its callbacks before those above
        ImGui_ImplGlfw_InitForOpenGL(window_, true);
        ImGui_ImplOpenGL3_Init("#version 330 core");
        last_time_s_ = glfwGetTime();
    }
    ~Window() override {
        ImGui_ImplOpenGL3_Shutdown();
        ImGui_ImplGlfw_Shutdown();
        ImGui::DestroyContext();
        glfwDestroyWindow(window_);
        glfwTerminate();
    }
    Window(const Window&) = delete;
    Window& operator=(const Window&) = delete;

    std::string description() const override {
        const auto* name = reinterpret_cast<const char*>(glGetString(GL_RENDERER));
        return std::string("window, ") + (name == nullptr ? "unknown renderer" : name);
    }
    bool is_window() const override { return true; }
    double display_hz() const override {
        constexpr int kUsualHz = 60;  // for displays that report no rate, such as virtual ones
        const GLFWvidmode* mode = glfwGetVideoMode(glfwGetPrimaryMonitor());
        return mode != nullptr && mode->refreshRate > 0 ? mode->refreshRate : kUsualHz;
    }
    std::array<int, 2> size() const override {
        std::array<int, 2> size{};
        glfwGetFramebufferSize(window_, &size[0], &size[1]);
        return size;
    }

    SurfaceEvents poll() override {
        glfwPollEvents();
        events_.close = glfwWindowShouldClose(window_) != 0;
        read_mouse();
        read_keys();
        return std::exchange(events_, {});
    }

    void show(const renderer::SceneRenderer& renderer, const HudContent& content) override {
        if (has_two_buffers_)
            renderer.present_halves();
        else
            renderer.present();
        // even if nothing is laid out: ImGui needs it to know that mouse and keys are not for it
        ImGui_ImplOpenGL3_NewFrame();
        ImGui_ImplGlfw_NewFrame();
        ImGui::NewFrame();
        if (is_hud_shown_) draw_hud(content, has_details_);
        if (is_menu_shown_) menu_.draw(content, events_);
        is_dragging_ = content.edit.is_dragging;
        has_selection_ = content.edit.selected.has_value();
        edit_panel_.draw(content, events_);
        if (are_keys_shown_) draw_keys();
        ImGui::Render();
        ImGui_ImplOpenGL3_RenderDrawData(ImGui::GetDrawData());
        glFinish();  // separates drawing from waiting for the display
        const auto finished = std::chrono::steady_clock::now();
        glfwSwapBuffers(window_);
        waited_ = std::chrono::steady_clock::now() - finished;
    }
    std::chrono::steady_clock::duration waited_for_display() const override { return waited_; }

private:
    void pressed(int key) {
        if (ImGui::GetIO().WantTextInput) return;  // the user types a name
        if (pressed_for_editing(key)) return;
        if (key == GLFW_KEY_F12 || key == GLFW_KEY_P) events_.screenshot = true;
        if (key == GLFW_KEY_R) events_.reset_scene = true;
        if (key == GLFW_KEY_V) events_.reset_view = true;
        if (key == GLFW_KEY_F9) events_.record = true;
        if (key == GLFW_KEY_F) events_.follow = true;
        if (key >= GLFW_KEY_1 && key <= GLFW_KEY_9)
            events_.person = static_cast<std::size_t>(key - GLFW_KEY_0);
        if (key == GLFW_KEY_N) events_.names = true;
        if (key == GLFW_KEY_B) events_.debug = true;
        if (key == GLFW_KEY_T) has_details_ = !has_details_;
        if (key == GLFW_KEY_G) walks_ = !walks_;
        if (key == GLFW_KEY_F11) toggle_full_screen();
        if (key == GLFW_KEY_H) is_hud_shown_ = !is_hud_shown_;
        if (key == GLFW_KEY_M) is_menu_shown_ = !is_menu_shown_;
        if (key == GLFW_KEY_DELETE) events_.remove_pointed = !ImGui::GetIO().WantCaptureMouse;
        if (key == GLFW_KEY_ESCAPE) close_what_is_open();
    }
    // Returns true if the key is one of the editing. Letters are those of the keyboard's layout.
    bool pressed_for_editing(int key) {
        const char* name = glfwGetKeyName(key, 0);
        const char letter = name == nullptr ? '\0' : name[0];
        const bool has_control = is_down(GLFW_KEY_LEFT_CONTROL) || is_down(GLFW_KEY_RIGHT_CONTROL);
        const bool has_shift = is_down(GLFW_KEY_LEFT_SHIFT) || is_down(GLFW_KEY_RIGHT_SHIFT);
        EditEvents& edit = events_.edit;
        if (has_control && letter == 'z') (has_shift ? edit.redo : edit.undo) = true;
        if (has_control && letter == 'y') edit.redo = true;
        if (has_control && (letter == 'z' || letter == 'y')) return true;
        if (letter == 'j') edit.next_handles = true;
        if (letter == 'c') edit.local_axes = true;
        const bool is_axis = is_dragging_ && letter >= 'x' && letter <= 'z';
        if (is_axis) edit.axis = letter - 'x';
        return is_axis;
    }
    // by character: the key of '?' differs between keyboards
    void typed(unsigned character) {
        if (character == '?' && !ImGui::GetIO().WantTextInput) are_keys_shown_ = !are_keys_shown_;
    }
    void close_what_is_open() {
        if (is_dragging_ || (has_selection_ && !is_menu_shown_))
            events_.edit.cancel = true;
        else if (!std::exchange(is_menu_shown_, false))
            glfwSetWindowShouldClose(window_, GLFW_TRUE);
    }
    void toggle_full_screen() {
        if (glfwGetWindowMonitor(window_) != nullptr) {
            glfwSetWindowMonitor(
                window_, nullptr, windowed_[0], windowed_[1], windowed_[2], windowed_[3], 0);
            return;
        }
        GLFWmonitor* monitor = glfwGetPrimaryMonitor();
        const GLFWvidmode* mode = monitor == nullptr ? nullptr : glfwGetVideoMode(monitor);
        if (mode == nullptr) return;
        glfwGetWindowPos(window_, &windowed_[0], &windowed_[1]);
        glfwGetWindowSize(window_, &windowed_[2], &windowed_[3]);
        glfwSetWindowMonitor(window_, monitor, 0, 0, mode->width, mode->height, mode->refreshRate);
    }
    bool is_down(int key) const { return glfwGetKey(window_, key) == GLFW_PRESS; }

    void read_mouse() {
        Eigen::Vector2d at = Eigen::Vector2d::Zero();
        glfwGetCursorPos(window_, &at.x(), &at.y());
        const Eigen::Vector2d way = at - last_cursor_;
        last_cursor_ = at;
        // the cursor is in screen units, the picture in pixels
        std::array<int, 2> window{};
        glfwGetWindowSize(window_, &window[0], &window[1]);
        events_.pointer.at_px = at;
        events_.pointer.width_px = std::max(1, window[0]);
        events_.pointer.height_px = std::max(1, window[1]);
        // the menu consumes its own input
        if (ImGui::GetIO().WantCaptureMouse) return;
        events_.pointer.is_down = glfwGetMouseButton(window_, GLFW_MOUSE_BUTTON_LEFT) == GLFW_PRESS;
        if (events_.pointer.is_down) events_.motion.turn_px = way;
        if (glfwGetMouseButton(window_, GLFW_MOUSE_BUTTON_RIGHT) == GLFW_PRESS)
            events_.motion.pan_px = way;
        events_.motion.look_around = is_down(GLFW_KEY_LEFT_SHIFT) || is_down(GLFW_KEY_RIGHT_SHIFT);
    }
    void read_keys() {
        const double now_s = glfwGetTime();
        events_.motion.seconds = now_s - std::exchange(last_time_s_, now_s);
        events_.motion.walk = walks_;
        events_.edit.snaps = is_down(GLFW_KEY_LEFT_CONTROL) || is_down(GLFW_KEY_RIGHT_CONTROL);
        if (ImGui::GetIO().WantTextInput) return;
        const auto axis = [this](int plus, int minus) {
            return static_cast<double>(is_down(plus)) - static_cast<double>(is_down(minus));
        };
        events_.motion.fly = {axis(GLFW_KEY_D, GLFW_KEY_A),
                              axis(GLFW_KEY_W, GLFW_KEY_S),
                              axis(GLFW_KEY_E, GLFW_KEY_Q)};
    }

    GLFWwindow* window_;
    bool has_two_buffers_;
    bool is_hud_shown_ = true;
    bool are_keys_shown_ = false;
    bool is_menu_shown_ = false;
    bool has_details_ = false;
    Menu menu_;
    EditPanel edit_panel_;
    bool is_dragging_ = false;    // a handle, in the last picture
    bool has_selection_ = false;  // in the last picture
    bool walks_ = false;
    std::array<int, 4> windowed_{};  // position and size before full screen
    SurfaceEvents events_;
    Eigen::Vector2d last_cursor_ = Eigen::Vector2d::Zero();
    double last_time_s_ = 0.0;
    std::chrono::steady_clock::duration waited_{0};
};

}  // namespace

Expected<std::unique_ptr<Surface>> open_window(const SurfaceOptions& options) {
    if (std::getenv("DISPLAY") == nullptr)
        return make_error(ErrorKind::kUnavailable, "window: DISPLAY is not set");
    if (glfwInit() == GLFW_FALSE)
        return make_error(ErrorKind::kUnavailable, "window: " + last_glfw_error());
    glfwWindowHint(GLFW_CONTEXT_VERSION_MAJOR, 3);
    glfwWindowHint(GLFW_CONTEXT_VERSION_MINOR, 3);
    glfwWindowHint(GLFW_OPENGL_PROFILE, GLFW_OPENGL_CORE_PROFILE);
    glfwWindowHint(GLFW_STEREO, options.has_two_buffers ? GLFW_TRUE : GLFW_FALSE);
    GLFWwindow* window =
        glfwCreateWindow(options.width, options.height, "Atrium", nullptr, nullptr);
    if (window == nullptr) {
        const std::string reason = last_glfw_error();
        glfwTerminate();
        return make_error(ErrorKind::kUnavailable, "window: " + reason);
    }
    glfwMakeContextCurrent(window);
    if (auto loaded = gl::load_entry_points(&glfwGetProcAddress); !loaded) {
        glfwDestroyWindow(window);
        glfwTerminate();
        return tl::unexpected(loaded.error());
    }
    glfwSwapInterval(options.wait_for_display ? 1 : 0);
    return std::make_unique<Window>(window, options);
}

}  // namespace atrium::viewer
