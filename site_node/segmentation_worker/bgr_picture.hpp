#pragma once

#include "core/base/executor.hpp"
#include "core/image/image.hpp"
#include "core/image/raw_image.hpp"
#include "site_node/segmentation/background_model.hpp"

#include <cstdint>
#include <vector>

namespace atrium::segmentation_worker {

/// Converts pictures to packed 8-bit BGR, full range, as OpenCV and most networks take it. Reuse
/// it: keeps its memory. Not thread-safe.
class BgrPicture {
public:
    /// Writes `working`, the complete working view of `raw`, to `out`: 3 * width * height bytes,
    /// rows without padding. Copies a BGR picture as it is; interpolates a mosaic (bilinear); of
    /// YUV, the four pixels of a block have one chroma. Gives way after each 16 rows, but not
    /// within a mosaic.
    void write(const image::RawImage& raw,
               const image::YuvView& working,
               const GiveWay& give_way,
               std::uint8_t* out);

    /// Writes the background as the model has it now, with the light that it followed.
    void write(const segmentation::BackgroundModel& model,
               const GiveWay& give_way,
               std::uint8_t* out);

private:
    void write_yuv(const image::YuvView& picture, const GiveWay& give_way, std::uint8_t* out);

    std::vector<std::int16_t> chroma_;   // of two rows: what it adds to blue, green, red
    std::vector<std::uint8_t> colours_;  // of some rows: blue, green, red planes
    image::YuvImage background_;
};

}  // namespace atrium::segmentation_worker
