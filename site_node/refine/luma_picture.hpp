#pragma once

#include "core/geometry/pinhole_camera.hpp"
#include "core/image/colour_rows.hpp"
#include "core/image/image.hpp"

#include <cstdint>
#include <vector>

namespace atrium::refine {

/// Nearer to a camera nothing is seen [m].
inline constexpr double kNearest_m = 1e-3;

/// What a camera delivered. All of it is valid as long as the refinement runs.
struct PictureView {
    const geometry::CalibratedCamera* camera = nullptr;  // its contours are part of the hull
    image::YuvView picture;                              // empty: nothing is known
    const image::Mask* mask = nullptr;                   // as large as the picture
    image::PixelRect subject;                            // foreground lies in it
};

/// The luma of a person in one camera at half resolution, ready for sampling between pixels. Keeps
/// its memory.
struct LumaPicture {
    int width = 0;
    int height = 0;
    int first_x = 0;  // block (0, 0) has the pixels (2 first_x, 2 first_y) to (+1, +1)
    int first_y = 0;
    /// Four neighbours per pixel: itself in the low byte, then right, below, and below right. The
    /// last column and row repeat themselves.
    std::vector<std::uint32_t> taps;
    /// 1 where all pixels within kReach show the person, else 0.
    std::vector<std::uint8_t> inside;

    static constexpr int kReach = 2;

    /// Position of a pixel of the delivered picture, in pixels of this one.
    Eigen::Vector2f place(const Eigen::Vector2d& distorted_px) const {
        return {static_cast<float>(0.5 * (distorted_px.x() - 0.5) - first_x),
                static_cast<float>(0.5 * (distorted_px.y() - 0.5) - first_y)};
    }
};

/// Working memory of `fill`; one per thread.
struct LumaScratch {
    std::vector<std::uint8_t> luma;
    std::vector<std::uint8_t> across;
};

/// Fills `out` from the subject's part of the picture. Leaves it empty (width 0) if there is no
/// picture, mask or subject. All instruction sets give the same bits.
void fill(const PictureView& view,
          LumaScratch& scratch,
          LumaPicture& out,
          image::RowCode code = image::best_row_code());

}  // namespace atrium::refine
