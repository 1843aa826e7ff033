#pragma once

#include "site_node/hull/visual_hull.hpp"
#include "site_node/rig_check/diagnosis.hpp"

#include <array>
#include <string>

/// Pictures that somebody turned or mirrored after the calibration, for diagnosis.cpp.
namespace atrium::rig_check {

struct Flip {
    Cause cause = Cause::kTurned;
    bool is_x = false;  // pixel x becomes width - 1 - x
    bool is_y = false;  // pixel y becomes height - 1 - y
};

/// The one that people do most often first.
inline constexpr std::array<Flip, 3> kFlips{Flip{Cause::kTurned, true, true},
                                            Flip{Cause::kMirrored, true, false},
                                            Flip{Cause::kFlipped, false, true}};

/// Flips the silhouette of a view as its stored picture, which has the distortion of the lens.
/// Points that the lens cannot undistort there stay where they are. Contours keep their
/// orientation: foreground lies left.
void flip_contours(hull::SilhouetteView& view, const Flip& flip);

/// Cause and cure, for messages, if the pictures of one camera or of all are flipped.
std::string text_of_one(const Flip& flip, const std::string& camera);
std::string text_of_all(const Flip& flip);

}  // namespace atrium::rig_check
