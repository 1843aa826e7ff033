#pragma once

#include "core/base/expected.hpp"
#include "core/image/raw_image.hpp"

#include <Eigen/Core>

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace atrium::preview {

/// One camera in a preview.
struct View {
    std::string name;
    image::RawImage image;  // empty: no picture
    /// Blobs and holes in the delivered picture; even-odd rule.
    std::vector<std::vector<Eigen::Vector2d>> outlines_px;
    double frames_per_s = 0.0;
    double foreground_share = 0.0;          // of the picture's area, 0 to 1
    std::string caption;                    // below the view, instead of name, rate and share
    std::vector<Eigen::Vector2d> marks_px;  // encircled
    double brightness = 1.0;                // the picture is drawn so many times as bright
};

/// Packed BGR, rows from the top.
struct Picture {
    int width = 0;
    int height = 0;
    std::vector<std::uint8_t> bgr;
};

/// Draws all views in one grid, each at half size, with a tinted and outlined silhouette and a
/// caption. `out` is reusable.
void draw(const std::vector<View>& views, Picture& out);

/// Writes a PNG atomically, through a temporary file. Creates the folder. Error kUnavailable.
Expected<void> write_png(const std::filesystem::path& file, const Picture& picture);

}  // namespace atrium::preview
