#include "tests/support/virtual_display.hpp"

#include "core/base/descriptor.hpp"

#include <X11/XKBlib.h>
#include <X11/Xlib.h>
#include <X11/Xutil.h>
#include <X11/keysym.h>
#include <fcntl.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <string_view>

namespace atrium::test_support {
namespace {

constexpr int kStartPatience_ms = 30'000;

// While it lives the server serves nobody else: a found window stays.
class Grab {
public:
    explicit Grab(Display* display) : display_(display) { XGrabServer(display_); }
    ~Grab() {
        XUngrabServer(display_);
        XSync(display_, False);
    }
    Grab(const Grab&) = delete;
    Grab& operator=(const Grab&) = delete;

private:
    Display* display_;
};

struct Place {
    Window window = 0;
    int x = 0;
    int y = 0;
    int width = 0;
    int height = 0;
};

// A program may put what it shows before its name: "playroom - alice - Atrium".
bool is_titled(std::string_view name, const std::string& title) {
    return name == title || name.ends_with(" - " + title);
}

// Without a window manager, windows are children of the root.
std::optional<Place> find(Display* display, const std::string& title) {
    Window root = 0;
    Window parent = 0;
    Window* children = nullptr;
    unsigned count = 0;
    if (XQueryTree(display, DefaultRootWindow(display), &root, &parent, &children, &count) == 0)
        return std::nullopt;
    std::optional<Place> place;
    for (unsigned i = 0; i < count && !place; ++i) {
        char* name = nullptr;
        if (XFetchName(display, children[i], &name) == 0) continue;
        XWindowAttributes attributes;
        if (is_titled(name, title) &&
            XGetWindowAttributes(display, children[i], &attributes) != 0 &&
            attributes.map_state == IsViewable) {
            place = {children[i], attributes.x, attributes.y, attributes.width, attributes.height};
        }
        XFree(name);
    }
    if (children != nullptr) XFree(children);
    return place;
}

// Only calls that are safe between fork and exec.
[[noreturn]] void become_server(int number_to,
                                const char* number_to_text,
                                const char* screen,
                                pid_t parent) {
    fcntl(number_to, F_SETFD, 0);  // the child keeps this descriptor
    prctl(PR_SET_PDEATHSIG, SIGTERM);
    if (getppid() != parent) _exit(126);  // the parent ended before prctl took effect
    const int nowhere = open("/dev/null", O_WRONLY);
    dup2(nowhere, STDERR_FILENO);
    execlp("Xvfb",
           "Xvfb",
           "-displayfd",
           number_to_text,
           "-screen",
           "0",
           screen,
           "-nolisten",
           "tcp",
           "-noreset",
           static_cast<char*>(nullptr));
    _exit(127);
}

// The server's text when it is ready. Empty if it never is.
std::string read_number(int descriptor) {
    std::string number;
    char character = 0;
    pollfd ready{descriptor, POLLIN, 0};
    while (poll(&ready, 1, kStartPatience_ms) > 0 && read(descriptor, &character, 1) == 1) {
        if (character == '\n') return number;
        number += character;
    }
    return "";
}

}  // namespace

struct VirtualDisplay::Impl {
    pid_t server = 0;
    Display* display = nullptr;
    std::optional<std::string> former_name;

    Impl() = default;
    Impl(const Impl&) = delete;
    Impl& operator=(const Impl&) = delete;
    ~Impl() {
        if (display != nullptr) {
            XCloseDisplay(display);
            if (former_name) {
                setenv("DISPLAY", former_name->c_str(), 1);
            } else {
                unsetenv("DISPLAY");
            }
        }
        end_server();
    }

    void send(const std::string& title, XEvent& event) const {
        const Grab grab(display);
        const auto place = find(display, title);
        if (!place) return;
        event.xany.window = place->window;
        // without an event mask, the event goes to the window's owner
        XSendEvent(display, place->window, False, NoEventMask, &event);
    }

    int end_server() {
        int status = 0;
        if (server <= 0) return status;
        kill(server, SIGTERM);
        while (waitpid(server, &status, 0) < 0 && errno == EINTR) {
        }
        server = 0;
        return status;
    }
};

VirtualDisplay::VirtualDisplay(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
VirtualDisplay::~VirtualDisplay() = default;

Expected<std::unique_ptr<VirtualDisplay>> VirtualDisplay::start(int width, int height) {
    std::array<int, 2> pipe_ends{};
    if (pipe2(pipe_ends.data(), O_CLOEXEC) != 0)
        return make_error(ErrorKind::kUnavailable, std::string("a pipe: ") + std::strerror(errno));
    const Descriptor from_server(pipe_ends[0]);
    const std::string number_to = std::to_string(pipe_ends[1]);
    const std::string screen = std::to_string(width) + "x" + std::to_string(height) + "x24";
    auto impl = std::make_unique<Impl>();
    const pid_t parent = getpid();
    impl->server = fork();
    if (impl->server == 0) become_server(pipe_ends[1], number_to.c_str(), screen.c_str(), parent);
    close(pipe_ends[1]);
    const std::string number = read_number(from_server.get());
    if (number.empty()) {
        const int status = impl->end_server();
        if (WIFEXITED(status) && WEXITSTATUS(status) == 127)
            return make_error(ErrorKind::kNotFound, "Xvfb is not installed");
        return make_error(ErrorKind::kUnavailable, "Xvfb does not start");
    }
    const std::string name = ":" + number;
    impl->display = XOpenDisplay(name.c_str());
    if (impl->display == nullptr)
        return make_error(ErrorKind::kUnavailable, "Xvfb does not answer at " + name);
    if (const char* former = std::getenv("DISPLAY")) impl->former_name = former;
    setenv("DISPLAY", name.c_str(), 1);
    return std::unique_ptr<VirtualDisplay>(new VirtualDisplay(std::move(impl)));
}

std::optional<VirtualDisplay::Size> VirtualDisplay::size_of(const std::string& title) {
    const Grab grab(impl_->display);
    const auto place = find(impl_->display, title);
    if (!place) return std::nullopt;
    return Size{place->width, place->height};
}

std::optional<VirtualDisplay::Colour> VirtualDisplay::colour_in(const std::string& title,
                                                                int x,
                                                                int y) {
    Display* const display = impl_->display;
    const Grab grab(display);
    const auto place = find(display, title);
    if (!place || x < 0 || y < 0 || x >= place->width || y >= place->height) return std::nullopt;
    const int column = place->x + x;
    const int row = place->y + y;
    if (column < 0 || row < 0 || column >= DisplayWidth(display, DefaultScreen(display)) ||
        row >= DisplayHeight(display, DefaultScreen(display))) {
        return std::nullopt;
    }
    XImage* const image =
        XGetImage(display, DefaultRootWindow(display), column, row, 1, 1, AllPlanes, ZPixmap);
    if (image == nullptr) return std::nullopt;
    const unsigned long value = XGetPixel(image, 0, 0);  // of depth 24: 0xrrggbb
    XDestroyImage(image);
    return Colour{static_cast<int>(value >> 16 & 255),
                  static_cast<int>(value >> 8 & 255),
                  static_cast<int>(value & 255)};
}

void VirtualDisplay::resize(const std::string& title, const Size& size) {
    const Grab grab(impl_->display);
    const auto place = find(impl_->display, title);
    if (!place) return;
    XMoveResizeWindow(impl_->display,
                      place->window,
                      0,
                      0,
                      static_cast<unsigned>(size[0]),
                      static_cast<unsigned>(size[1]));
}

void VirtualDisplay::hold_key(const std::string& title,
                              const std::string& key,
                              bool is_down,
                              bool with_control) {
    const KeySym symbol = XStringToKeysym(key.c_str());
    XEvent event{};
    event.xkey.type = is_down ? KeyPress : KeyRelease;
    event.xkey.root = DefaultRootWindow(impl_->display);
    event.xkey.time = CurrentTime;
    event.xkey.same_screen = True;
    const KeyCode code = XKeysymToKeycode(impl_->display, symbol);
    event.xkey.keycode = code;
    const bool is_shifted = XkbKeycodeToKeysym(impl_->display, code, 0, 0) != symbol;
    event.xkey.state = (is_shifted ? ShiftMask : 0U) | (with_control ? ControlMask : 0U);
    impl_->send(title, event);
}

void VirtualDisplay::point_at(const std::string& title, int x, int y) {
    const Grab grab(impl_->display);
    const auto place = find(impl_->display, title);
    if (place) XWarpPointer(impl_->display, None, place->window, 0, 0, 0, 0, x, y);
}

void VirtualDisplay::hold_button(const std::string& title, bool is_down) {
    XEvent event{};
    event.xbutton.type = is_down ? ButtonPress : ButtonRelease;
    event.xbutton.root = DefaultRootWindow(impl_->display);
    event.xbutton.time = CurrentTime;
    event.xbutton.same_screen = True;
    event.xbutton.button = Button1;
    event.xbutton.state = is_down ? 0 : Button1Mask;
    impl_->send(title, event);
}

void VirtualDisplay::ask_to_close(const std::string& title) {
    XEvent event{};
    event.xclient.type = ClientMessage;
    event.xclient.message_type = XInternAtom(impl_->display, "WM_PROTOCOLS", False);
    event.xclient.format = 32;
    event.xclient.data.l[0] =
        static_cast<long>(XInternAtom(impl_->display, "WM_DELETE_WINDOW", False));
    impl_->send(title, event);
}

}  // namespace atrium::test_support
