#pragma once

#include "core/codec/texture_codec.hpp"
#include "core/image/image.hpp"

#include <Eigen/Core>

namespace atrium::motion {

/// Camera pixels per pixel of a MotionPicture.
constexpr int kMotionDivisor = 4;

/// What one camera shows of a subject, at a quarter of its resolution. Pixel (x, y) of the planes
/// is the mean of the camera's pixels [4 (rect.x + x), 4 (rect.x + x) + 4) and likewise for rows.
struct MotionPicture {
    image::PixelRect rect;  // in pixels of a quarter of the resolution; empty: sees nobody
    image::Plane luma;      // smooth outside the subject
    image::Mask mask;       // 255 where at least half of the pixel shows the subject

    bool empty() const { return rect.empty(); }
};

/// Reduces a texture at half or full resolution. An empty crop gives an empty picture.
void reduce(const codec::TextureCrop& crop, MotionPicture& out);

/// The place in a picture of a quarter of the resolution of a place in the camera's picture.
inline Eigen::Vector2d reduced_px(const Eigen::Vector2d& camera_px) {
    return ((camera_px.array() + 0.5) / kMotionDivisor - 0.5).matrix();
}

/// Copies the luma of the part `rect` of the picture. Outside it the nearest pixels are repeated.
void copy_part(const MotionPicture& picture, const image::PixelRect& rect, image::Plane& out);

}  // namespace atrium::motion
