#include "viewer/ui/surface.hpp"

#include "core/app/log.hpp"

namespace atrium::viewer {

Expected<std::unique_ptr<Surface>> open_surface(const SurfaceOptions& options) {
    if (options.context == ContextKind::kWindow) return open_window(options);
    if (options.context != ContextKind::kAuto || options.is_headless) return open_headless(options);
    auto window = open_window(options);
    if (window) return window;
    const std::string& why_no_window = window.error().message;
    if (options.has_two_buffers) return window;
    auto headless = open_headless(options);
    if (headless) {
        app::log::info("surface_headless reason=\"{}\"", why_no_window);
        return headless;
    }
    return make_error(ErrorKind::kUnavailable,
                      "cannot open a window (" + why_no_window + ") or a context without one (" +
                          headless.error().message + ")");
}

}  // namespace atrium::viewer
