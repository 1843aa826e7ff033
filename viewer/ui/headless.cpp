#include "core/app/log.hpp"
#include "core/gl/egl_context.hpp"
#include "core/gl/offscreen_context.hpp"
#include "viewer/ui/surface.hpp"

#include <glad/gl.h>

#include <utility>

namespace atrium::viewer {
namespace {

template <typename Context>
class Headless : public Surface {
public:
    Headless(Context context, const std::string& library, const SurfaceOptions& options)
        : context_(std::move(context)), library_(library), size_{options.width, options.height} {}

    std::string description() const override {
        const auto* name = reinterpret_cast<const char*>(glGetString(GL_RENDERER));
        return library_ + ", " + (name == nullptr ? "unknown renderer" : name) + ", no window";
    }
    bool is_window() const override { return false; }
    double display_hz() const override { return 0.0; }
    std::array<int, 2> size() const override { return size_; }
    SurfaceEvents poll() override { return {}; }
    void show(const renderer::SceneRenderer&, const HudContent&) override { glFinish(); }
    void show_layout(const std::function<void()>&) override {}
    void set_title(const std::string&) override {}
    double content_scale() const override { return 1.0; }
    std::chrono::steady_clock::duration waited_for_display() const override { return {}; }

private:
    Context context_;
    std::string library_;
    std::array<int, 2> size_;
};

Expected<std::unique_ptr<Surface>> open_egl(gl::EglDevices devices, const SurfaceOptions& options) {
    auto context = gl::EglContext::create(devices);
    if (!context) return tl::unexpected(context.error());
    return std::make_unique<Headless<gl::EglContext>>(std::move(*context), "EGL", options);
}

Expected<std::unique_ptr<Surface>> open_osmesa(const SurfaceOptions& options) {
    // the renderer draws into its own framebuffer, so the context's can be small
    auto context = gl::OffscreenContext::create(16, 16);
    if (!context) return tl::unexpected(context.error());
    return std::make_unique<Headless<gl::OffscreenContext>>(std::move(*context), "OSMesa", options);
}

}  // namespace

Expected<std::unique_ptr<Surface>> open_headless(const SurfaceOptions& options) {
    if (options.context == ContextKind::kEgl) return open_egl(gl::EglDevices::kAny, options);
    if (options.context == ContextKind::kOsmesa) return open_osmesa(options);
    auto on_gpu = open_egl(gl::EglDevices::kHardware, options);
    if (on_gpu) return on_gpu;
    app::log::info("surface_software reason=\"{}\" see=\"atrium doctor --for viewer\"",
                   on_gpu.error().message);
    return open_osmesa(options);
}

}  // namespace atrium::viewer
