#include "viewer/renderer/picture_target.hpp"

#include <glad/gl.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <utility>

namespace atrium::renderer {

Expected<PictureTarget> PictureTarget::create(int width, int height, Antialias antialias) {
    PictureTarget made;
    if (antialias == Antialias::kFxaa) {
        auto fxaa = Fxaa::create();
        if (!fxaa) return tl::unexpected(fxaa.error());
        made.fxaa_ = std::move(*fxaa);
    }
    if (auto sized = made.resize(width, height); !sized) return tl::unexpected(sized.error());
    return made;
}

Expected<void> PictureTarget::resize(int width, int height) {
    const image::PixelRect part_px = scaled({0, 0, width, height});
    auto scene = gl::make_framebuffer(part_px.width, part_px.height);
    if (!scene) return tl::unexpected(scene.error());
    gl::Framebuffer full;
    if (scale_ < 1.0) {
        auto made = gl::make_framebuffer(width, height);
        if (!made) return tl::unexpected(made.error());
        full = std::move(*made);
    }
    if (fxaa_)
        if (auto ok = fxaa_->resize(part_px.width, part_px.height); !ok) return ok;
    scene_ = std::move(*scene);
    enlarged_ = std::move(full);
    width_ = width;
    height_ = height;
    return {};
}

Expected<void> PictureTarget::set_scale(double scale) {
    assert(scale > 0.0 && scale <= 1.0);
    if (scale == scale_) return {};
    const double before = std::exchange(scale_, scale);
    auto made = resize(width_, height_);
    if (!made) scale_ = before;
    return made;
}

image::PixelRect PictureTarget::scaled(const image::PixelRect& part_px) const {
    const auto at = [this](int px) { return static_cast<int>(std::lround(scale_ * px)); };
    image::PixelRect part{at(part_px.x), at(part_px.y), 0, 0};
    part.width = std::max(1, at(part_px.x + part_px.width) - part.x);
    part.height = std::max(1, at(part_px.y + part_px.height) - part.y);
    return part;
}

void PictureTarget::begin_eye(const EyeView& eye, const gl::Framebuffer& on) {
    glViewport(eye.part_px.x,
               on.height - eye.part_px.y - eye.part_px.height,
               eye.part_px.width,
               eye.part_px.height);
    glColorMask(eye.writes[0], eye.writes[1], eye.writes[2], GL_TRUE);
}

void PictureTarget::finish() {
    if (fxaa_) fxaa_->draw(scene_);
    if (scale_ < 1.0) enlarge();
    picture().bind();
}

void PictureTarget::enlarge() const {
    glBindFramebuffer(GL_READ_FRAMEBUFFER, smoothed().name.id());
    glBindFramebuffer(GL_DRAW_FRAMEBUFFER, enlarged_.name.id());
    glBlitFramebuffer(0,
                      0,
                      scene_.width,
                      scene_.height,
                      0,
                      0,
                      enlarged_.width,
                      enlarged_.height,
                      GL_COLOR_BUFFER_BIT,
                      GL_LINEAR);
}

void PictureTarget::present(const image::PixelRect& part_px, unsigned buffer) const {
    glBindFramebuffer(GL_READ_FRAMEBUFFER, picture().name.id());
    glBindFramebuffer(GL_DRAW_FRAMEBUFFER, 0);
    if (buffer != 0) glDrawBuffer(buffer);
    glBlitFramebuffer(part_px.x,
                      part_px.y,
                      part_px.x + part_px.width,
                      part_px.y + part_px.height,
                      0,
                      0,
                      part_px.width,
                      part_px.height,
                      GL_COLOR_BUFFER_BIT,
                      GL_NEAREST);
    glBindFramebuffer(GL_FRAMEBUFFER, 0);
    glViewport(0, 0, part_px.width, part_px.height);
}

void PictureTarget::read_pixels(RenderedPicture& out) const {
    const gl::Framebuffer& from = picture();
    const std::size_t stride = static_cast<std::size_t>(from.width) * 4;
    const auto height = static_cast<std::size_t>(from.height);
    rows_.resize(stride * height);
    out.rgba.resize(stride * height);
    out.width = from.width;
    out.height = from.height;
    from.bind();
    gl::read_rgba(from.width, from.height, rows_);
    for (std::size_t y = 0; y < height; ++y)
        std::copy_n(rows_.data() + (height - 1 - y) * stride, stride, out.rgba.data() + y * stride);
}

}  // namespace atrium::renderer
