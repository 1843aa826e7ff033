#pragma once

#include "core/base/expected.hpp"
#include "core/image/image.hpp"

#include <filesystem>
#include <string>
#include <vector>

/// Masks of other programs.
namespace atrium::calibrate {

/// What the values of a recording's masks mean.
struct MaskReading {
    bool labels = false;    // numbers of people or parts of the body: all but the background
    bool inverted = false;  // people are black

    /// Whether a site reads the files in the same way.
    bool is_of_site() const { return !labels && !inverted; }
};

/// Reads a mask. Errors of capture::PictureFile.
Expected<image::Mask> read_mask(const std::filesystem::path& file, const MaskReading& reading);

/// Labels in masks: each pixel has the number or colour of a person, a thing or a part of the body.
struct MaskLabels {
    bool are_labels = false;
    std::size_t num_labels = 0;  // in all, beside the background
    bool have_palette = false;
};

/// Whether masks hold at least three labels, or a palette whose background is not black. A site
/// reads simpler ones as they are. Background is the first colour of a palette, else black or 0.
///
/// No label masks are photographs, soft outlines and what JPEG makes of a mask. They have more than
/// 64 values, or a value above half of the largest possible one (unless in colours), or no
/// background along most of the border, or change from pixel to pixel: in label masks at least 3 of
/// 4 neighbours in people are equal.
MaskLabels find_labels(const std::vector<std::filesystem::path>& masks);

/// Why a PNG with a palette holds no labels; empty for other files.
std::string why_no_labels(const std::filesystem::path& mask);

}  // namespace atrium::calibrate
