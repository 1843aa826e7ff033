#include "site_node/rig_check/flips.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace atrium::rig_check {
namespace {

// How a flip is called, who makes it, and ffmpeg's filter that takes it back.
struct FlipWords {
    const char* what;
    const char* maker;
    const char* filter;
};

FlipWords words_of(const Flip& flip) {
    if (flip.cause == Cause::kMirrored)
        return {"mirrored left-right",
                "turn mirroring off in the camera (ReverseX) or in the program that records",
                "hflip"};
    return {"flipped upside down, not turned",
            "turn flipping off in the camera (ReverseY) or in the program that records",
            "vflip"};
}

}  // namespace

void flip_contours(hull::SilhouetteView& view, const Flip& flip) {
    const geometry::PinholeCamera& lens = view.intrinsics;
    for (auto& contour : view.contours) {
        for (Eigen::Vector2d& pixel : contour) {
            Eigen::Vector2d stored = lens.distort(pixel);
            if (flip.is_x) stored.x() = lens.width - 1 - stored.x();
            if (flip.is_y) stored.y() = lens.height - 1 - stored.y();
            pixel = lens.undistort(stored).value_or(pixel);
        }
        if (flip.is_x != flip.is_y) std::ranges::reverse(contour);
    }
}

std::string text_of_one(const Flip& flip, const std::string& camera) {
    if (flip.cause == Cause::kTurned)
        return fmt::format(
            "{} contradicts all others, but not if its pictures are turned by 180 degrees: give "
            "them as the camera took them when it was calibrated, also if that is upside down "
            "(ffmpeg -i FILE -vf hflip,vflip OUT), or calibrate it as it hangs now",
            camera);
    const FlipWords words = words_of(flip);
    return fmt::format(
        "{} contradicts all others, but not if its pictures are {}: {}, or take it back in its "
        "files (ffmpeg -i FILE -vf {} OUT)",
        camera,
        words.what,
        words.maker,
        words.filter);
}

std::string text_of_all(const Flip& flip) {
    if (flip.cause == Cause::kTurned)
        return "the pictures of all cameras look turned by 180 degrees: give them as the cameras "
               "took them when they were calibrated (ffmpeg -i FILE -vf hflip,vflip OUT, for every "
               "file), or calibrate again";
    const FlipWords words = words_of(flip);
    return fmt::format(
        "the pictures of all cameras look {}: {}, or take it back in every file "
        "(ffmpeg -i FILE -vf {} OUT)",
        words.what,
        words.maker,
        words.filter);
}

}  // namespace atrium::rig_check
