#pragma once

#include "core/codec/texture_codec.hpp"
#include "core/image/colour_rows.hpp"
#include "core/image/image.hpp"
#include "site_node/texture/fill_background.hpp"

#include <cstdint>
#include <vector>

namespace atrium::texture {

/// Size of a texture relative to the camera picture.
enum class Resolution : std::uint8_t { kHalf, kFull };

/// Keeps full-resolution samples near the 0.3 MB planned for the largest sample.
constexpr int kMaxFullPixels = 1 << 20;

struct TextureOptions {
    int padding_px = 4;  // around the subject's bounding rectangle, full-resolution pixels
    Resolution resolution = Resolution::kHalf;
};

/// Reusable memory; one per thread.
struct TextureScratch {
    std::vector<FillBlock> blocks;
    std::vector<std::uint8_t> outline;
};

/// Crops the picture to `subject`, a rectangle around the foreground of the mask. At half
/// resolution Y is the mean of the foreground in each 2x2 block (of a mosaic: the luma of the
/// block), U and V are unchanged, and a pixel is foreground if at least two of its four are. At
/// full resolution Y and mask are unchanged and U and V are interpolated, as is Y of a mosaic. A
/// subject of more than kMaxFullPixels stays at half resolution.
///
/// The chroma of a coloured background is taken out of the outline (clean_outline_chroma). The
/// background of the result is smooth (fill_background).
///
/// Returns false and leaves `out` unchanged if `subject` is empty. `subject` must lie in the
/// picture. `mask` has the size of `frame`; a last odd column or row, which a 4:2:0 picture cannot
/// have, is ignored. Allocates only while `scratch` and `out` grow. All instruction sets give the
/// same bits.
[[nodiscard]] bool crop_texture(const image::YuvView& frame,
                                const image::Mask& mask,
                                const image::PixelRect& subject,
                                const TextureOptions& options,
                                TextureScratch& scratch,
                                codec::TextureCrop& out,
                                image::RowCode code = image::best_row_code());

}  // namespace atrium::texture
