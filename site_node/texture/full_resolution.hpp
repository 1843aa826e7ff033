#pragma once

#include "core/codec/texture_codec.hpp"
#include "core/image/image.hpp"

namespace atrium::texture {

/// Copies the luma of `crop`; interpolates it (bilinear) for a mosaic, with the pixels around the
/// crop. `crop` must have even coordinates and sizes and lie in the picture. `out` must have the
/// size of the crop.
void full_luma(const image::YuvView& frame, const image::PixelRect& crop, image::Plane& out);

/// Interpolates one chroma plane to twice its size; a sample lies in the middle of the 2x2 pixels
/// that share it. Same conditions as above.
void full_chroma(const image::PlaneView& chroma, const image::PixelRect& crop, image::Plane& out);

}  // namespace atrium::texture
