#include "core/gl/offscreen_context.hpp"
#include "viewer/surface.hpp"

#include <glad/gl.h>

namespace atrium::viewer {
namespace {

class Headless : public Surface {
public:
    Headless(gl::OffscreenContext context, const SurfaceOptions& options)
        : context_(std::move(context)), size_{options.width, options.height} {}

    std::string description() const override { return "OSMesa, no window"; }
    bool is_window() const override { return false; }
    double display_hz() const override { return 0.0; }
    std::array<int, 2> size() const override { return size_; }
    SurfaceEvents poll() override { return {}; }
    void show(const renderer::SceneRenderer&, const HudFigures&) override { glFinish(); }

private:
    gl::OffscreenContext context_;
    std::array<int, 2> size_;
};

}  // namespace

Expected<std::unique_ptr<Surface>> open_headless(const SurfaceOptions& options) {
    if (options.has_two_buffers) {
        return make_error(ErrorKind::kUnavailable,
                          "display.stereo: quad_buffer needs a window, not headless");
    }
    // pictures are drawn into the renderer's own framebuffer: the context's stays small
    auto context = gl::OffscreenContext::create(16, 16);
    if (!context) return tl::unexpected(context.error());
    return std::make_unique<Headless>(std::move(*context), options);
}

}  // namespace atrium::viewer
