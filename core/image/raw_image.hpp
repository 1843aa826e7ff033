#pragma once

#include "core/image/image.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>

namespace atrium::image {

/// How the bytes of a picture are laid out. All are full-range, 8 bits a sample.
enum class PixelFormat : std::uint8_t {
    kYuv420,   // three planes, as YuvImage
    kMono8,    // luma only
    kBayerRG,  // colour mosaics; named by the first two pixels of the first row
    kBayerGR,
    kBayerGB,
    kBayerBG,
    kRgb,   // packed
    kBgr,   // packed
    kUyvy,  // 4:2:2: U Y0 V Y1
    kYuyv,  // 4:2:2: Y0 U Y1 V
};

/// Bytes that one row of `width` pixels takes in the first plane.
std::size_t row_bytes(PixelFormat format, int width);

/// The first two pixels of a mosaic's first row; kNone for all that is no mosaic.
Mosaic mosaic_of(PixelFormat format);

/// A picture as its source made it, shared and never copied: camera buffers go back to the driver
/// when the last owner lets go. Empty: there is no picture.
struct RawImage {
    struct RawPlane {
        const std::uint8_t* data = nullptr;
        std::size_t stride_bytes = 0;
    };
    PixelFormat format = PixelFormat::kYuv420;
    int width = 0;
    int height = 0;
    std::array<RawPlane, 3> planes;     // all but kYuv420 use only the first
    std::shared_ptr<const void> owner;  // of the memory

    RawImage() = default;
    /// Null: empty.
    RawImage(std::shared_ptr<const YuvImage> image);  // NOLINT: a YuvImage is a picture, too

    bool empty() const { return planes[0].data == nullptr; }
};

/// The picture in the form in which the site works (even size: an odd last column or row is left
/// out). What can be used as it is is not copied: all of kYuv420, the luma of kMono8, the samples
/// of a mosaic. The rest is computed into `buffer`, which has to outlive the view and allocates
/// only when the size changes. `raw` is not empty.
///
/// A mosaic is not interpolated: its `y` are the sensor's samples, each in its own colour, and
/// `u`, `v` are the chroma of each 2x2 block.
YuvView working_view(const RawImage& raw, YuvImage& buffer);

/// The same, part by part, for who reads each part while it is in the cache.
class WorkingPicture {
public:
    /// A picture that is there: there is nothing to make.
    explicit WorkingPicture(const YuvView& view) : view_(view) {}
    /// Nothing is made yet. The memory of `raw` (not empty), and `buffer`, outlive this.
    WorkingPicture(const RawImage& raw, YuvImage& buffer);

    /// The whole picture; values are those of the parts that were made.
    const YuvView& view() const { return view_; }

    /// `part` lies in the picture, its numbers are even. Parts may overlap.
    void make(const PixelRect& part);
    void make_all() { make({0, 0, view_.width(), view_.height()}); }

private:
    PixelFormat format_ = PixelFormat::kYuv420;
    PlaneView source_;            // the first plane
    YuvImage* buffer_ = nullptr;  // null where nothing has to be computed
    YuvView view_;
};

}  // namespace atrium::image
