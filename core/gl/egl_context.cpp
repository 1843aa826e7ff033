#include "core/gl/egl_context.hpp"

#include "core/gl/entry_points.hpp"

// keeps the names of X11 out
#define EGL_NO_PLATFORM_SPECIFIC_TYPES
#include <EGL/egl.h>
#include <EGL/eglext.h>

#include <algorithm>
#include <array>
#include <string_view>
#include <utility>
#include <vector>

namespace atrium::gl {
namespace {

constexpr const char* kNoDriver =
    "no driver for rendering without a display; install libegl-mesa0 or the GPU's own driver";

struct Device {
    EGLDeviceEXT handle = EGL_NO_DEVICE_EXT;
    bool is_hardware = false;
};

template <typename Function>
Function entry_point(const char* name) {
    return reinterpret_cast<Function>(eglGetProcAddress(name));
}

bool has_word(const char* list, std::string_view word) {
    std::string_view rest = list == nullptr ? "" : list;
    while (!rest.empty()) {
        const auto end = std::min(rest.find(' '), rest.size());
        if (rest.substr(0, end) == word) return true;
        rest.remove_prefix(std::min(end + 1, rest.size()));
    }
    return false;
}

Error unavailable(const std::string& what) { return {ErrorKind::kUnavailable, "EGL: " + what}; }

Error failure(const std::string& what) {
    constexpr std::array<const char*, 15> kNames{"success",
                                                 "not initialised",
                                                 "bad access",
                                                 "bad alloc",
                                                 "bad attribute",
                                                 "bad config",
                                                 "bad context",
                                                 "bad current surface",
                                                 "bad display",
                                                 "bad match",
                                                 "bad native pixmap",
                                                 "bad native window",
                                                 "bad parameter",
                                                 "bad surface",
                                                 "context lost"};
    const auto number = static_cast<std::size_t>(eglGetError() - EGL_SUCCESS);
    return unavailable(what + " (" + (number < kNames.size() ? kNames[number] : "unknown reason") +
                       ")");
}

// Lists the EGL devices, hardware first.
Expected<std::vector<Device>> find_devices() {
    const char* extensions = eglQueryString(EGL_NO_DISPLAY, EGL_EXTENSIONS);
    const bool has_devices = has_word(extensions, "EGL_EXT_device_enumeration") ||
                             has_word(extensions, "EGL_EXT_device_base");
    if (!has_devices || !has_word(extensions, "EGL_EXT_platform_device"))
        return tl::unexpected(unavailable(kNoDriver));
    const auto query_devices = entry_point<PFNEGLQUERYDEVICESEXTPROC>("eglQueryDevicesEXT");
    const auto query_string =
        entry_point<PFNEGLQUERYDEVICESTRINGEXTPROC>("eglQueryDeviceStringEXT");
    if (query_devices == nullptr || query_string == nullptr)
        return tl::unexpected(unavailable("the installed driver does not list its devices"));
    std::array<EGLDeviceEXT, 32> handles{};
    EGLint num = 0;
    if (query_devices(static_cast<EGLint>(handles.size()), handles.data(), &num) != EGL_TRUE)
        num = 0;
    std::vector<Device> devices;
    for (std::size_t i = 0; i < static_cast<std::size_t>(num); ++i) {
        const char* abilities = query_string(handles[i], EGL_EXTENSIONS);
        devices.push_back({handles[i], !has_word(abilities, "EGL_MESA_device_software")});
    }
    std::stable_partition(
        devices.begin(), devices.end(), [](const Device& device) { return device.is_hardware; });
    return devices;
}

// True for Mesa's software renderers, which also serve device nodes without a driver.
bool is_software(std::string_view renderer) {
    for (const char* name : {"llvmpipe", "softpipe", "swrast", "Software Rasterizer"})
        if (renderer.find(name) != std::string_view::npos) return true;
    return false;
}

}  // namespace

struct EglContext::Impl {
    // Stays initialised until the process ends: EGL shares one display per device in a process and
    // does not count its users.
    EGLDisplay display = EGL_NO_DISPLAY;
    EGLSurface surface = EGL_NO_SURFACE;  // small: pictures are drawn into framebuffers
    EGLContext context = EGL_NO_CONTEXT;
    bool is_hardware = false;

    Impl() = default;
    Impl(const Impl&) = delete;
    Impl& operator=(const Impl&) = delete;
    ~Impl() {
        if (context != EGL_NO_CONTEXT) {
            if (eglGetCurrentContext() == context) leave();
            eglDestroyContext(display, context);
        }
        if (surface != EGL_NO_SURFACE) eglDestroySurface(display, surface);
    }

    void leave() const { eglMakeCurrent(display, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT); }
    Expected<void> enter() const {
        if (eglMakeCurrent(display, surface, surface, context) == EGL_TRUE) return {};
        return tl::unexpected(failure("cannot make a context current"));
    }
    Expected<void> open(const Device& device);
};

Expected<void> EglContext::Impl::open(const Device& device) {
    const auto display_of =
        entry_point<PFNEGLGETPLATFORMDISPLAYEXTPROC>("eglGetPlatformDisplayEXT");
    if (display_of == nullptr)
        return tl::unexpected(unavailable("the installed driver cannot select a device"));
    display = display_of(EGL_PLATFORM_DEVICE_EXT, device.handle, nullptr);
    if (display == EGL_NO_DISPLAY || eglInitialize(display, nullptr, nullptr) != EGL_TRUE)
        return tl::unexpected(failure("a device cannot be opened"));
    if (eglBindAPI(EGL_OPENGL_API) != EGL_TRUE)
        return tl::unexpected(failure("a device has no OpenGL"));
    constexpr EGLint kConfig[] = {
        EGL_SURFACE_TYPE, EGL_PBUFFER_BIT, EGL_RENDERABLE_TYPE, EGL_OPENGL_BIT, EGL_NONE};
    EGLConfig config = nullptr;
    EGLint num_configs = 0;
    if (eglChooseConfig(display, kConfig, &config, 1, &num_configs) != EGL_TRUE || num_configs < 1)
        return tl::unexpected(failure("a device has no configuration for pbuffers"));
    constexpr EGLint kSurface[] = {EGL_WIDTH, 16, EGL_HEIGHT, 16, EGL_NONE};
    surface = eglCreatePbufferSurface(display, config, kSurface);
    if (surface == EGL_NO_SURFACE)
        return tl::unexpected(failure("a device cannot create a pbuffer"));
    constexpr EGLint kContext[] = {EGL_CONTEXT_MAJOR_VERSION,
                                   3,
                                   EGL_CONTEXT_MINOR_VERSION,
                                   3,
                                   EGL_CONTEXT_OPENGL_PROFILE_MASK,
                                   EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT,
                                   EGL_NONE};
    context = eglCreateContext(display, config, EGL_NO_CONTEXT, kContext);
    if (context == EGL_NO_CONTEXT)
        return tl::unexpected(failure("a device has no OpenGL 3.3 core context"));
    if (auto current = enter(); !current) return current;
    is_hardware = device.is_hardware;
    if (!is_hardware) return {};
    // query directly: other contexts may use the table of entry points
    constexpr unsigned kRenderer = 0x1F01;  // GL_RENDERER
    const auto get_string = entry_point<const unsigned char* (*)(unsigned)>("glGetString");
    const auto* text =
        get_string == nullptr ? nullptr : reinterpret_cast<const char*>(get_string(kRenderer));
    if (text != nullptr && !is_software(text)) return {};
    return tl::unexpected(unavailable(std::string("a device has no hardware driver (renderer: ") +
                                      (text == nullptr ? "none" : text) + ")"));
}

EglContext::EglContext(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
EglContext::EglContext(EglContext&&) noexcept = default;
EglContext& EglContext::operator=(EglContext&&) noexcept = default;
EglContext::~EglContext() = default;

Expected<EglContext> EglContext::create(EglDevices devices) {
    const auto found = find_devices();
    if (!found) return tl::unexpected(found.error());
    std::string reasons;
    for (const Device& device : *found) {
        if (!device.is_hardware && devices == EglDevices::kHardware) continue;
        auto impl = std::make_unique<Impl>();
        auto opened = impl->open(device);
        if (opened) opened = load_entry_points(&eglGetProcAddress);
        if (opened) return EglContext(std::move(impl));
        reasons += (reasons.empty() ? "" : "; ") + opened.error().message;
    }
    if (!reasons.empty()) return make_error(ErrorKind::kUnavailable, reasons);
    return tl::unexpected(
        unavailable(found->empty() ? kNoDriver : "no GPU, or no permission to open one"));
}

Expected<void> EglContext::make_current() { return impl_->enter(); }
void EglContext::release() { impl_->leave(); }
bool EglContext::is_hardware() const { return impl_->is_hardware; }

}  // namespace atrium::gl
