#pragma once

#include "core/codec/texture_codec.hpp"
#include "core/image/image.hpp"

namespace atrium::texture {

/// Removes the hue of a coloured background, a green floor or screen, from the outline of a cropped
/// texture.
///
/// A pixel at the outline shows both the person and what is behind. Where the background just
/// outside (in `frame`) is saturated, and its chroma differs from the person's a little further
/// inside, the background's share of the pixel's chroma is replaced by the inner chroma. Luma, thin
/// parts, and outlines before neutral backgrounds keep their values. `divisor` is the number of
/// pixels of `frame` per pixel of `crop`. The background of `crop` is not read.
void clean_outline_chroma(const image::YuvView& frame, int divisor, codec::TextureCrop& crop);

}  // namespace atrium::texture
