#pragma once

#include "core/base/expected.hpp"
#include "core/gl/resources.hpp"
#include "viewer/renderer/drawing/view_camera.hpp"
#include "viewer/renderer/fxaa.hpp"
#include "viewer/renderer/rendered_picture.hpp"

#include <cstdint>
#include <optional>
#include <vector>

namespace atrium::renderer {

/// Holds the framebuffers of a picture: the scene at a share of its size, anti-aliased, enlarged.
class PictureTarget {
public:
    static Expected<PictureTarget> create(int width, int height, Antialias antialias);

    /// Sets the size of the picture [px]. On failure the former size stays.
    Expected<void> resize(int width, int height);
    int width() const { return width_; }
    int height() const { return height_; }
    /// Sets the size of the scene as a share in (0, 1] of the picture's width and height.
    Expected<void> set_scale(double scale);
    double scale() const { return scale_; }

    /// Framebuffer of the scene.
    const gl::Framebuffer& scene() const { return scene_; }
    /// Scales a part of the picture to the scene. Adjacent parts stay adjacent.
    image::PixelRect scaled(const image::PixelRect& part_px) const;
    /// Sets the viewport in `on` and the colour mask of an eye.
    static void begin_eye(const EyeView& eye, const gl::Framebuffer& on);

    /// Makes the picture from the scene: smooths and enlarges it. Binds the picture.
    void finish();
    const gl::Framebuffer& picture() const { return scale_ < 1.0 ? enlarged_ : smoothed(); }

    /// Copies a part of the picture into `buffer` of the window, or into its current buffer if 0.
    void present(const image::PixelRect& part_px, unsigned buffer) const;
    /// Reads the picture back. Reuses the memory of `out`.
    void read_pixels(RenderedPicture& out) const;

private:
    PictureTarget() = default;
    // the scene before it is enlarged
    const gl::Framebuffer& smoothed() const { return fxaa_ ? fxaa_->picture() : scene_; }
    void enlarge() const;

    int width_ = 0;
    int height_ = 0;
    double scale_ = 1.0;
    gl::Framebuffer scene_;                   // at `scale_` of the picture's size
    std::optional<Fxaa> fxaa_;                // only with anti-aliasing, of the size of `scene_`
    gl::Framebuffer enlarged_;                // only if `scale_` is not 1
    mutable std::vector<std::uint8_t> rows_;  // scratch of `read_pixels`, bottom row first
};

}  // namespace atrium::renderer
