#pragma once

#include "core/codec/texture_codec.hpp"
#include "core/image/image.hpp"

namespace atrium::texture {

/// The luma of each pixel of `crop`, all of whose numbers are even and which lies in the picture;
/// of a mosaic interpolated (bilinear), as what is around the crop says. `out` is as large as the
/// crop.
void whole_luma(const image::YuvView& frame, const image::PixelRect& crop, image::Plane& out);

/// One plane of chroma at twice its size, interpolated: it is sited in the middle of the 2x2 pixels
/// that share it. As above.
void whole_chroma(const image::PlaneView& chroma, const image::PixelRect& crop, image::Plane& out);

}  // namespace atrium::texture
