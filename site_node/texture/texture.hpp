#pragma once

#include "core/codec/texture_codec.hpp"
#include "core/image/colour_rows.hpp"
#include "core/image/image.hpp"
#include "site_node/texture/fill_background.hpp"

#include <cstdint>
#include <vector>

namespace atrium::texture {

/// How large the texture of a camera is beside its picture.
enum class Resolution : std::uint8_t { kHalf, kFull };

/// So that samples of full resolution stay near the 0.3 MB that the largest is foreseen to have.
constexpr int kMaxFullPixels = 1 << 20;

struct TextureOptions {
    int padding_px = 4;  // kept around the subject's bounding rectangle, full-resolution pixels
    Resolution resolution = Resolution::kHalf;
};

/// Reused memory; one per thread.
struct TextureScratch {
    std::vector<FillBlock> blocks;
    std::vector<std::uint8_t> outline;
};

/// Cuts out `subject`, a rectangle around what the mask shows. At half resolution Y is the mean of
/// the foreground in each 2x2 block (of a mosaic: the block's luma), U and V are as they are, and a
/// pixel is foreground if at least two of its four are. At full resolution Y and the mask are as
/// they are, U and V interpolated, of a mosaic Y as well. A subject of more than kMaxFullPixels
/// stays at half resolution.
///
/// Where the result is background it is made smooth (fill_background).
///
/// Returns false, with `out` as it was, if `subject` is empty: there is nothing to send. It lies in
/// the picture. `mask` is as large as `frame`; a last odd column or row, which a 4:2:0 picture
/// cannot have, is ignored. Allocates only while `scratch` and `out` grow. All sets of instructions
/// give the same bits.
[[nodiscard]] bool crop_texture(const image::YuvView& frame,
                                const image::Mask& mask,
                                const image::PixelRect& subject,
                                const TextureOptions& options,
                                TextureScratch& scratch,
                                codec::TextureCrop& out,
                                image::RowCode code = image::best_row_code());

/// Smallest rectangle that holds all foreground; empty if there is none. Reads the whole mask: who
/// has its contours knows the rectangle (silhouette::bounding_rect).
image::PixelRect bounding_rect(const image::Mask& mask);

}  // namespace atrium::texture
