#include "core/gl/offscreen_context.hpp"

#include "core/gl/entry_points.hpp"

#include <GL/osmesa.h>

#include <cassert>
#include <cstdint>
#include <vector>

namespace atrium::gl {
namespace {

struct DestroyContext {
    void operator()(OSMesaContext context) const { OSMesaDestroyContext(context); }
};
using OwnedContext = std::unique_ptr<osmesa_context, DestroyContext>;

std::size_t num_bytes(int width, int height) {
    return static_cast<std::size_t>(width) * static_cast<std::size_t>(height) * 4;
}

}  // namespace

struct OffscreenContext::Impl {
    std::vector<std::uint8_t> default_framebuffer;  // RGBA; must outlive the context
    int width = 0;
    int height = 0;
    OwnedContext context;
};

OffscreenContext::OffscreenContext(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
OffscreenContext::OffscreenContext(OffscreenContext&&) noexcept = default;
OffscreenContext& OffscreenContext::operator=(OffscreenContext&&) noexcept = default;
OffscreenContext::~OffscreenContext() = default;

Expected<OffscreenContext> OffscreenContext::create(int width, int height) {
    assert(width > 0 && height > 0);
    constexpr int kAttributes[] = {OSMESA_FORMAT,
                                   OSMESA_RGBA,
                                   OSMESA_DEPTH_BITS,
                                   24,
                                   OSMESA_STENCIL_BITS,
                                   8,
                                   OSMESA_PROFILE,
                                   OSMESA_CORE_PROFILE,
                                   OSMESA_CONTEXT_MAJOR_VERSION,
                                   3,
                                   OSMESA_CONTEXT_MINOR_VERSION,
                                   3,
                                   0,
                                   0};
    auto impl = std::make_unique<Impl>();
    impl->context.reset(OSMesaCreateContextAttribs(kAttributes, nullptr));
    if (!impl->context) {
        return make_error(ErrorKind::kUnavailable,
                          "OSMesa: cannot create an OpenGL 3.3 core context");
    }
    impl->width = width;
    impl->height = height;
    impl->default_framebuffer.resize(num_bytes(width, height));
    OffscreenContext context(std::move(impl));
    if (auto current = context.make_current(); !current) return tl::unexpected(current.error());
    if (auto loaded = load_entry_points(&OSMesaGetProcAddress); !loaded)
        return tl::unexpected(loaded.error());
    return context;
}

Expected<void> OffscreenContext::make_current() {
    constexpr unsigned kUnsignedByte = 0x1401;  // GL_UNSIGNED_BYTE
    if (!OSMesaMakeCurrent(impl_->context.get(),
                           impl_->default_framebuffer.data(),
                           kUnsignedByte,
                           impl_->width,
                           impl_->height)) {
        return make_error(ErrorKind::kUnavailable,
                          "OSMesa: cannot make a context of " + std::to_string(impl_->width) + "x" +
                              std::to_string(impl_->height) + " current");
    }
    return {};
}

void OffscreenContext::release() { OSMesaMakeCurrent(nullptr, nullptr, 0, 0, 0); }

}  // namespace atrium::gl
