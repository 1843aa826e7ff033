#include "viewer/ui/surface.hpp"

#include "core/app/log.hpp"

#include <map>
#include <string>

namespace atrium::viewer {

Expected<SurfaceOptions> surface_options(const ViewerConfig& config) {
    static const std::map<std::string, ContextKind> kContexts{{"auto", ContextKind::kAuto},
                                                              {"window", ContextKind::kWindow},
                                                              {"egl", ContextKind::kEgl},
                                                              {"osmesa", ContextKind::kOsmesa}};
    const SurfaceOptions options{.width = config.view.width,
                                 .height = config.view.height,
                                 .context = kContexts.at(config.view.context),
                                 .is_headless = config.headless,
                                 .wait_for_display = config.view.max_fps == 0.0,
                                 .has_two_buffers = config.display.stereo == "quad_buffer",
                                 .ui_scale = config.view.ui_scale};
    if (options.context == ContextKind::kWindow && options.is_headless) {
        return make_error(ErrorKind::kConfiguration,
                          "view.context: \"window\" contradicts headless");
    }
    if (options.has_two_buffers && (options.is_headless || options.context == ContextKind::kEgl ||
                                    options.context == ContextKind::kOsmesa)) {
        return make_error(ErrorKind::kConfiguration,
                          "display.stereo: quad_buffer needs a window; remove headless and "
                          "view.context");
    }
    return options;
}

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
                          headless.error().message + "); see atrium doctor --for viewer");
}

}  // namespace atrium::viewer
