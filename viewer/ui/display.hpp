#pragma once

#include "core/base/expected.hpp"
#include "viewer/config/viewer_config.hpp"
#include "viewer/control/mouse_grab.hpp"
#include "viewer/renderer/drawing/view_camera.hpp"
#include "viewer/ui/wall.hpp"

#include <Eigen/Core>

#include <array>
#include <chrono>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace atrium::viewer {

/// How the pictures for the two eyes are combined.
enum class Stereo : std::uint8_t {
    kNone,
    kSideBySide,  // each at half the width, the left eye's on the left
    kTopBottom,   // each at half the height, the left eye's on top
    kAnaglyph,    // red for the left eye, green and blue for the right eye
    /// Side by side in the picture; the window copies the halves to the driver's stereo buffers.
    kQuadBuffer
};

/// Computes the views that a display needs: one for a monitor, two for stereo, or the part of a
/// wall that one projector shows.
class Display {
public:
    /// Error kConfiguration if the wall file cannot be read or has no such tile.
    static Expected<Display> create(const DisplayConfig& config);

    /// Size of the picture to draw for a surface of `surface_px` [px].
    std::array<int, 2> picture_size(std::array<int, 2> surface_px) const;
    /// Views for a picture of that size. A tile of a wall ignores `camera`.
    std::vector<renderer::EyeView> eyes(const renderer::ViewCamera& camera,
                                        int width,
                                        int height) const;
    /// Maps a pointer on the surface to the picture of the eye under it.
    Pointer over_one_eye(Pointer pointer) const;

    /// Width of a pixel over its height on the tile, for a surface of that size. 1 without a wall.
    double pixel_aspect(std::array<int, 2> surface_px) const;

    Stereo stereo() const { return stereo_; }
    bool is_tile() const { return tile_.has_value(); }
    /// Capture time to show at `now`. Empty: show the newest. All tiles of a wall show the same
    /// moments, `delay` in the past, so the data of all have arrived. The clocks of their hosts
    /// must agree.
    std::optional<Timestamp> instant(Timestamp now) const;
    /// Age of the moments shown. 0 if the newest is shown.
    std::chrono::nanoseconds delay() const { return delay_; }

private:
    Stereo stereo_ = Stereo::kNone;
    double eye_distance_m_ = 0.0;
    double convergence_m_ = 0.0;
    std::chrono::nanoseconds delay_{0};
    std::optional<Wall> wall_;
    std::optional<Tile> tile_;
};

}  // namespace atrium::viewer
