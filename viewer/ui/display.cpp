#include "viewer/ui/display.hpp"

#include "viewer/renderer/screen.hpp"

#include <cmath>
#include <map>
#include <utility>

namespace atrium::viewer {
namespace {

using renderer::EyeView;
using renderer::Screen;
using renderer::ViewCamera;

const std::map<std::string, Stereo> kStereo{{"none", Stereo::kNone},
                                            {"side_by_side", Stereo::kSideBySide},
                                            {"top_bottom", Stereo::kTopBottom},
                                            {"anaglyph", Stereo::kAnaglyph},
                                            {"quad_buffer", Stereo::kQuadBuffer}};
constexpr std::chrono::nanoseconds kInstants{1'000'000'000 / 60};

Screen in_world(const Wall& wall, const Screen& screen) {
    return {wall.world_from_wall * screen.lower_left_m,
            wall.world_from_wall * screen.lower_right_m,
            wall.world_from_wall * screen.upper_left_m};
}

bool is_beside(Stereo stereo) {
    return stereo == Stereo::kSideBySide || stereo == Stereo::kQuadBuffer;
}

// Returns the part of a picture that the left (0) or right (1) eye sees.
image::PixelRect part_of(Stereo stereo, int eye, int width, int height) {
    if (is_beside(stereo)) {
        const int left = width / 2;
        return eye == 0 ? image::PixelRect{0, 0, left, height}
                        : image::PixelRect{left, 0, width - left, height};
    }
    if (stereo == Stereo::kTopBottom) {
        const int upper = height / 2;
        return eye == 0 ? image::PixelRect{0, 0, width, upper}
                        : image::PixelRect{0, upper, width, height - upper};
    }
    return {0, 0, width, height};
}

}  // namespace

Expected<Display> Display::create(const DisplayConfig& config) {
    Display display;
    display.stereo_ = kStereo.at(config.stereo);
    display.eye_distance_m_ = config.eye_distance_m;
    display.convergence_m_ = config.convergence_m;
    if (config.wall.empty()) {
        if (config.tile.empty()) return display;
        return make_error(ErrorKind::kConfiguration, "display.tile: needs display.wall");
    }
    auto wall = load_wall(config.wall);
    if (!wall) return tl::unexpected(wall.error());
    const Tile* tile = wall->find(config.tile);
    if (tile == nullptr) {
        return make_error(
            ErrorKind::kConfiguration,
            "display.tile: must be one of " + wall->tile_names() + ", got \"" + config.tile + "\"");
    }
    display.tile_ = *tile;
    display.wall_ = std::move(*wall);
    display.delay_ = std::chrono::nanoseconds(std::llround(1e6 * config.delay_ms));
    return display;
}

std::array<int, 2> Display::picture_size(std::array<int, 2> surface_px) const {
    if (stereo_ == Stereo::kQuadBuffer) surface_px[0] *= 2;
    return surface_px;
}

double Display::pixel_aspect(std::array<int, 2> surface_px) const {
    if (!tile_) return 1.0;
    const Screen& screen = tile_->screen_wall;
    const double width_m = (screen.lower_right_m - screen.lower_left_m).norm();
    const double height_m = (screen.upper_left_m - screen.lower_left_m).norm();
    return (width_m / surface_px[0]) / (height_m / surface_px[1]);
}

std::vector<EyeView> Display::eyes(const ViewCamera& camera, int width, int height) const {
    Screen screen;
    Eigen::Vector3d middle_m = camera.position_m;
    if (tile_) {
        screen = in_world(*wall_, tile_->screen_wall);
        middle_m = wall_->world_from_wall * wall_->eye_wall_m;
    } else if (stereo_ == Stereo::kNone) {
        return {renderer::eye_of(camera, width, height)};
    } else {
        const double distance_m =
            convergence_m_ > 0.0 ? convergence_m_ : (camera.target_m - camera.position_m).norm();
        const int shown_width = stereo_ == Stereo::kQuadBuffer ? width / 2 : width;
        const double aspect = static_cast<double>(shown_width) / height;
        screen = renderer::screen_of(camera, aspect, distance_m);
    }
    // the eyes lie side by side along the whole wall, not along one tile
    const Eigen::Vector3d across =
        tile_ ? Eigen::Vector3d(wall_->world_from_wall.rotation * Eigen::Vector3d::UnitX())
              : screen.right();
    const auto eye_at = [&](double offset_m, const image::PixelRect& part_px) {
        return renderer::eye_through(
            screen, middle_m + offset_m * across, camera.near_m, camera.far_m, part_px);
    };
    if (stereo_ == Stereo::kNone) return {eye_at(0.0, {0, 0, width, height})};
    std::vector<EyeView> eyes;
    for (const int eye : {0, 1}) {
        eyes.push_back(eye_at((eye - 0.5) * eye_distance_m_, part_of(stereo_, eye, width, height)));
        if (stereo_ == Stereo::kAnaglyph) eyes.back().writes = {eye == 0, eye == 1, eye == 1};
    }
    return eyes;
}

Pointer Display::over_one_eye(Pointer pointer) const {
    if (stereo_ == Stereo::kSideBySide)
        pointer.at_px.x() = 2.0 * std::fmod(pointer.at_px.x(), 0.5 * pointer.width_px);
    if (stereo_ == Stereo::kTopBottom)
        pointer.at_px.y() = 2.0 * std::fmod(pointer.at_px.y(), 0.5 * pointer.height_px);
    return pointer;
}

std::optional<Timestamp> Display::instant(Timestamp now) const {
    if (!tile_) return std::nullopt;
    const std::int64_t shown_ns = now.ns - delay_.count();
    return Timestamp{shown_ns - shown_ns % kInstants.count()};
}

}  // namespace atrium::viewer
