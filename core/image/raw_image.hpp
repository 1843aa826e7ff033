#pragma once

#include "core/image/image.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>

namespace atrium::image {

/// Memory layout of a picture. All are full-range with 8 bits per sample.
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

/// Returns the bytes of a row of `width` pixels in the first plane.
std::size_t row_bytes(PixelFormat format, int width);

/// Returns the mosaic of a Bayer format; kNone for other formats.
Mosaic mosaic_of(PixelFormat format);

/// A picture in the layout of its source, shared without copies: a camera buffer returns to the
/// driver when its last owner is destroyed. May be empty.
struct RawImage {
    struct RawPlane {
        const std::uint8_t* data = nullptr;
        std::size_t stride_bytes = 0;
    };
    PixelFormat format = PixelFormat::kYuv420;
    int width = 0;
    int height = 0;
    std::array<RawPlane, 3> planes;     // only kYuv420 uses more than the first
    std::shared_ptr<const void> owner;  // keeps the memory alive

    RawImage() = default;
    /// Refers to `image`; empty if it is null.
    RawImage(std::shared_ptr<const YuvImage> image);  // NOLINT: implicit conversion is intended

    bool empty() const { return planes[0].data == nullptr; }
};

/// Returns the picture in the site's format, without an odd last column or row. Does not copy
/// usable data: all of kYuv420, the luma of kMono8, the samples of a mosaic. Computes the rest into
/// `buffer`, which must outlive the view and reallocates only if the size changes. `raw` must not
/// be empty.
///
/// Does not interpolate a mosaic: `y` has the sensor's samples, each in the colour of its filter,
/// and `u`, `v` have the chroma of each 2x2 block.
YuvView working_view(const RawImage& raw, YuvImage& buffer);

/// Computes a `working_view` part by part, to read each part while it is in the cache.
class WorkingPicture {
public:
    /// Refers to a complete picture: `make` does nothing.
    explicit WorkingPicture(const YuvView& view) : view_(view) {}
    /// Refers to a raw picture without computing anything yet. The memory of `raw` (not empty) and
    /// `buffer` must outlive this object.
    WorkingPicture(const RawImage& raw, YuvImage& buffer);

    /// The whole picture; only the parts passed to `make` have valid values.
    const YuvView& view() const { return view_; }

    /// Computes a part. It lies within the picture and its four numbers are even. Parts may
    /// overlap.
    void make(const PixelRect& part);
    void make_all() { make({0, 0, view_.width(), view_.height()}); }

private:
    PixelFormat format_ = PixelFormat::kYuv420;
    PlaneView source_;            // the first plane
    YuvImage* buffer_ = nullptr;  // null if nothing has to be computed
    YuvView view_;
};

}  // namespace atrium::image
