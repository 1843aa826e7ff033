#include "core/gl/entry_points.hpp"
#include "viewer/overlay/label_scale.hpp"
#include "viewer/ui/fields.hpp"
#include "viewer/ui/full_screen.hpp"
#include "viewer/ui/keys.hpp"
#include "viewer/ui/panel_style.hpp"
#include "viewer/ui/panels.hpp"
#include "viewer/ui/surface.hpp"
#include "viewer/ui/tapped_keys.hpp"
#include "viewer/ui/ui_scale.hpp"

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
#include <optional>
#include <set>
#include <utility>
#include <vector>

namespace atrium::viewer {
namespace {

constexpr float kDoubleClickS = 0.3f;
constexpr float kDoubleClickPictures = 5.0f;  // down, up, down, and one between

std::string last_glfw_error() {
    const char* text = nullptr;
    glfwGetError(&text);
    return text == nullptr ? "unknown reason" : text;
}

class Window : public Surface {
public:
    Window(GLFWwindow* window, const SurfaceOptions& options)
        : window_(window),
          has_two_buffers_(options.has_two_buffers),
          wanted_ui_scale_(options.ui_scale) {
        glfwSetWindowUserPointer(window_, this);
        glfwSetKeyCallback(window_, [](GLFWwindow* w, int key, int, int action, int modifiers) {
            auto& self = *static_cast<Window*>(glfwGetWindowUserPointer(w));
            if (action == GLFW_RELEASE) self.in_chords_.erase(key);
            if (action != GLFW_PRESS) return;
            if ((modifiers & GLFW_MOD_CONTROL) != 0) self.in_chords_.insert(key);
            self.taps_.pressed(key);
            const bool is_letter_meant = self.is_dragging_ || (modifiers & GLFW_MOD_CONTROL) != 0;
            if (is_letter_meant) key = key_of_letter(key);
            const auto found = find_key(key, modifiers, self.is_dragging_);
            if (found && (!self.are_keys_taken() || self.acts_over_popup(key)))
                self.pressed(*found);
        });
        glfwSetCharCallback(window_, [](GLFWwindow* w, unsigned character) {
            static_cast<Window*>(glfwGetWindowUserPointer(w))->typed(character);
        });
        glfwSetScrollCallback(window_, [](GLFWwindow* w, double, double steps) {
            if (ImGui::GetIO().WantCaptureMouse) return;
            static_cast<Window*>(glfwGetWindowUserPointer(w))->events_.motion.zoom_steps += steps;
        });
        // A hand moves on until the next picture: what counts is where it pressed. glfwGetCursorPos
        // asks where the cursor is now.
        glfwSetCursorPosCallback(window_, [](GLFWwindow* w, double x, double y) {
            static_cast<Window*>(glfwGetWindowUserPointer(w))->moved_to_ = {x, y};
        });
        glfwSetMouseButtonCallback(window_, [](GLFWwindow* w, int, int action, int) {
            auto& self = *static_cast<Window*>(glfwGetWindowUserPointer(w));
            if (action == GLFW_PRESS && !self.was_pressed_) self.pressed_at_ = self.moved_to_;
        });
        // a click may begin and end between two slow pictures
        glfwSetInputMode(window_, GLFW_STICKY_MOUSE_BUTTONS, GLFW_TRUE);
        // ImGui keeps its context in a global: only one window at a time
        ImGui::CreateContext();
        ImGui::GetIO().IniFilename = nullptr;
        ImGui::GetIO().ConfigDragClickToInputText = true;
        ImGui::GetIO().UserData = &typed_;
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
        is_layout_only_ = false;
        is_dragging_ = content.edit.is_dragging;
        if (has_two_buffers_)
            renderer.present_halves();
        else
            renderer.present();
        // even if nothing is laid out: ImGui needs it to know that mouse and keys are not for it
        lay_out([&] { panels_.draw(content, events_); });
        swap();
    }
    void show_layout(const std::function<void()>& layout) override {
        is_layout_only_ = true;
        const auto [width, height] = size();
        glBindFramebuffer(GL_FRAMEBUFFER, 0);
        glViewport(0, 0, width, height);
        glClearColor(0.16f, 0.18f, 0.21f, 1.0f);
        glClear(GL_COLOR_BUFFER_BIT);
        lay_out(layout);
        swap();
    }
    double content_scale() const override {
        std::array<float, 2> scale{1.0f, 1.0f};
        glfwGetWindowContentScale(window_, &scale[0], &scale[1]);
        return static_cast<double>(std::max(scale[0], scale[1]));
    }
    void set_title(const std::string& to) override { glfwSetWindowTitle(window_, to.c_str()); }
    std::chrono::steady_clock::duration waited_for_display() const override { return waited_; }

private:
    void lay_out(const std::function<void()>& layout) {
        sizes_.set_scale(ui_scale_of(wanted_ui_scale_, size(), content_scale()));
        ImGui_ImplOpenGL3_NewFrame();
        ImGui_ImplGlfw_NewFrame();
        taps_.begin_frame();
        ImGuiIO& io = ImGui::GetIO();
        // pictures may take longer than a click
        io.MouseDoubleClickTime = std::max(kDoubleClickS, kDoubleClickPictures * io.DeltaTime);
        ImGui::NewFrame();
        take_typed_letters();
        layout();
        ImGui::Render();
        taps_.end_frame();
        ImGui_ImplOpenGL3_RenderDrawData(ImGui::GetDrawData());
    }
    void swap() {
        glFinish();  // separates drawing from waiting for the display
        const auto finished = std::chrono::steady_clock::now();
        glfwSwapBuffers(window_);
        waited_ = std::chrono::steady_clock::now() - finished;
    }
    // By a field that is typed into or held by the mouse, or by an open list or colour picker.
    static bool are_keys_taken() {
        return ImGui::GetIO().WantTextInput || ImGui::IsAnyItemActive() || is_popup_open();
    }
    static bool acts_over_popup(int key) {
        const bool is_function_key = key >= GLFW_KEY_F1 && key <= GLFW_KEY_F12;
        return !ImGui::GetIO().WantTextInput && (is_function_key || key == GLFW_KEY_ESCAPE);
    }
    void pressed(const PressedKey& key) {
        if (is_layout_only_) {
            if (key.action == Action::kFullScreen) full_screen_.toggle(window_);
            return;
        }
        if (!panels_.allows(key.action)) return;
        if (change_view(key, events_) || change_selected(key, events_.edit) ||
            change_playback(key, events_))
            return;
        if (panels_.change(key.action, events_)) return;
        switch (key.action) {
            case Action::kWalk:
                walks_ = !walks_;
                events_.edit.hint = walks_ ? "W A S D walk on the floor; G: fly again" : "flying";
                break;
            case Action::kRemovePointed:
                events_.remove_pointed = true;
                events_.is_over_panel = ImGui::GetIO().WantCaptureMouse;
                break;
            case Action::kFullScreen:
                full_screen_.toggle(window_);
                break;
            case Action::kClose:
                if (panels_.close_last(events_)) glfwSetWindowShouldClose(window_, GLFW_TRUE);
                break;
            default:
                break;
        }
    }
    // by character: the key of '?' differs between keyboards
    void typed(unsigned character) {
        if (character == '?' && !is_layout_only_ && !are_keys_taken()) panels_.toggle_keys();
    }
    bool is_down(int key) const { return glfwGetKey(window_, key) == GLFW_PRESS; }
    // Ctrl+D, of which Ctrl was let go first, is no D.
    bool flies(int key) const { return is_down(key) && !in_chords_.contains(key); }

    void read_mouse() {
        Eigen::Vector2d at = Eigen::Vector2d::Zero();
        glfwGetCursorPos(window_, &at.x(), &at.y());
        const bool is_left = glfwGetMouseButton(window_, GLFW_MOUSE_BUTTON_LEFT) == GLFW_PRESS;
        const bool is_right = glfwGetMouseButton(window_, GLFW_MOUSE_BUTTON_RIGHT) == GLFW_PRESS;
        const bool is_press = (is_left || is_right) && !was_pressed_;
        const auto pressed_at = std::exchange(pressed_at_, std::nullopt);
        if (is_press) at = pressed_at.value_or(at);
        // the cursor is in screen units, the picture in pixels
        std::array<int, 2> window{};
        glfwGetWindowSize(window_, &window[0], &window[1]);
        // a drag across half the window turns the view alike in small and in large windows
        const Eigen::Vector2d way =
            (at - last_cursor_) / std::max(1.0, window[1] / kReferenceHeight_px);
        last_cursor_ = at;
        events_.pointer.at_px = at;
        events_.pointer.width_px = std::max(1, window[0]);
        events_.pointer.height_px = std::max(1, window[1]);
        // panels consume their own input, also a press in the picture in which the mouse reaches
        // them
        const bool is_on_panel =
            is_press && is_panel_at(static_cast<float>(at.x()), static_cast<float>(at.y()));
        if (ImGui::GetIO().WantCaptureMouse || is_on_panel) return;
        was_pressed_ = is_left || is_right;
        events_.pointer.is_down = is_left;
        // the way to the place of the press is no drag
        if (is_left && !is_press) events_.motion.turn_px = way;
        if (is_right && !is_press) events_.motion.pan_px = way;
        events_.motion.look_around = is_down(GLFW_KEY_LEFT_SHIFT) || is_down(GLFW_KEY_RIGHT_SHIFT);
    }
    void read_keys() {
        const double now_s = glfwGetTime();
        events_.motion.seconds = now_s - std::exchange(last_time_s_, now_s);
        events_.motion.walk = walks_;
        events_.edit.snaps = is_down(GLFW_KEY_LEFT_CONTROL) || is_down(GLFW_KEY_RIGHT_CONTROL);
        if (are_keys_taken()) return;
        if (is_down(GLFW_KEY_LEFT_CONTROL) || is_down(GLFW_KEY_RIGHT_CONTROL)) return;
        const auto axis = [this](int plus, int minus) {
            return static_cast<double>(flies(plus)) - static_cast<double>(flies(minus));
        };
        events_.motion.fly = {axis(GLFW_KEY_D, GLFW_KEY_A),
                              axis(GLFW_KEY_W, GLFW_KEY_S),
                              axis(GLFW_KEY_E, GLFW_KEY_Q)};
    }

    GLFWwindow* window_;
    bool has_two_buffers_;
    double wanted_ui_scale_;
    UiSizes sizes_;
    bool is_layout_only_ = false;  // the last picture was of `show_layout`
    Panels panels_;
    TypedText typed_;
    bool is_dragging_ = false;  // a handle, in the last picture
    TappedKeys taps_;
    std::set<int> in_chords_;  // keys that are down since they were pressed with Ctrl
    bool walks_ = false;
    FullScreen full_screen_;
    SurfaceEvents events_;
    Eigen::Vector2d last_cursor_ = Eigen::Vector2d::Zero();
    bool was_pressed_ = false;                   // on the world, in the last picture
    std::optional<Eigen::Vector2d> moved_to_;    // by the last event
    std::optional<Eigen::Vector2d> pressed_at_;  // since the last picture
    double last_time_s_ = 0.0;
    std::chrono::steady_clock::duration waited_{0};
};

}  // namespace

Expected<std::unique_ptr<Surface>> open_window(const SurfaceOptions& options) {
    if (std::getenv("DISPLAY") == nullptr)
        return make_error(ErrorKind::kUnavailable,
                          "window: DISPLAY is not set; start the viewer on a desktop or through "
                          "ssh -X, or use --headless");
    if (glfwInit() == GLFW_FALSE) {
        return make_error(ErrorKind::kUnavailable,
                          "window: " + last_glfw_error() +
                              "; check DISPLAY, and that this user may open it (XAUTHORITY)");
    }
    glfwWindowHint(GLFW_CONTEXT_VERSION_MAJOR, 3);
    glfwWindowHint(GLFW_CONTEXT_VERSION_MINOR, 3);
    glfwWindowHint(GLFW_OPENGL_PROFILE, GLFW_OPENGL_CORE_PROFILE);
    glfwWindowHint(GLFW_STEREO, options.has_two_buffers ? GLFW_TRUE : GLFW_FALSE);
    GLFWwindow* window =
        glfwCreateWindow(options.width, options.height, kWindowTitle, nullptr, nullptr);
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
