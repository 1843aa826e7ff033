#pragma once

#include "core/base/expected.hpp"
#include "core/config/option_set.hpp"
#include "viewer/mouse_grab.hpp"
#include "viewer/renderer/view_camera.hpp"
#include "viewer/wall.hpp"

#include <Eigen/Core>

#include <array>
#include <chrono>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace atrium::viewer {

struct DisplayConfig {
    std::string stereo = "none";
    double eye_distance_m = 0.064;
    double convergence_m = 0.0;    // 0: at the target
    std::filesystem::path wall{};  // empty: a display by itself
    std::string tile{};
    double delay_ms = 120.0;
};

/// Declares every option, with its unit, on `set`.
void declare(DisplayConfig& config, config::OptionSet& set);

/// How two pictures reach two eyes.
enum class Stereo : std::uint8_t {
    kNone,
    kSideBySide,  // each squeezed to half of the width, the left eye's on the left
    kTopBottom,   // each squeezed to half of the height, the left eye's on top
    kAnaglyph,    // red is the left eye's, green and blue the right one's
    kQuadBuffer   // side by side in the picture; the window hands them to the driver
};

/// What the eyes before a display see of the world: a monitor's, those of two eyes, or a
/// projector's share of a wall.
class Display {
public:
    /// Error kConfiguration where the wall cannot be read or has no such tile.
    static Expected<Display> create(const DisplayConfig& config);

    /// Of the picture to draw for a surface of a size [px].
    std::array<int, 2> picture_size(std::array<int, 2> surface_px) const;
    /// For a picture of that size. A tile of a wall shows its part of the world, whatever `camera`.
    std::vector<renderer::EyeView> eyes(const renderer::ViewCamera& camera,
                                        int width,
                                        int height) const;
    /// Where a pointer on the surface is in the picture of the eye that it is over.
    Pointer over_one_eye(Pointer pointer) const;

    /// How many times as wide as high a pixel of such a surface is on the tile; 1 without a wall.
    double pixel_aspect(std::array<int, 2> surface_px) const;

    Stereo stereo() const { return stereo_; }
    bool is_tile() const { return tile_.has_value(); }
    /// The moment to show at `now`: nothing where the newest is shown. All tiles of a wall show the
    /// same moments, a while ago, so that each has what it needs; their clocks must agree.
    std::optional<Timestamp> instant(Timestamp now) const;
    /// How long ago that was; 0 where the newest is shown.
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
