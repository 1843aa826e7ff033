#include "site_node/rig_check/hull_size.hpp"

#include "site_node/rig_check/length_mistakes.hpp"

#include <fmt/format.h>

namespace atrium::rig_check {
namespace {

constexpr double kHugeVolume_m3 = 50.0;  // some hundred people
constexpr double kHugeExtent_m = 50.0;
constexpr double kTall_m = 3.5;         // taller than a person who stretches, on a chair
constexpr double kAlwaysTall_m = 2.45;  // 1.9 m, and an arm that is always up
constexpr double kAlwaysSmall_m = 1.2;  // a child of seven years, or somebody who sits
constexpr double kUsual_m = 1.75;
constexpr double kTinyVolume_m3 = 1e-4;
constexpr double kTinyExtent_m = 0.1;
// A person of two years has 12 l, and the hull of few cameras is larger than the person.
constexpr double kSmallVolume_m3 = 0.005;
constexpr double kSmallExtent_m = 0.6;
constexpr double kFatVolume_m3 = 0.01;  // of a person in miniature before few cameras

}  // namespace

std::optional<std::string> check_size(const geometry::Aabb& extent,
                                      double volume_m3,
                                      double coverage) {
    if (extent.empty()) return std::nullopt;
    const Eigen::Vector3d size = extent.size();
    const std::string is = fmt::format("the hull is {:.3g} x {:.3g} x {:.3g} m large, {:.3g} m3",
                                       size.x(),
                                       size.y(),
                                       size.z(),
                                       volume_m3);
    const bool is_huge = volume_m3 > kHugeVolume_m3 || size.maxCoeff() > kHugeExtent_m;
    const bool is_tiny = volume_m3 < kTinyVolume_m3 && size.maxCoeff() < kTinyExtent_m;
    if (is_huge && coverage <= 0.8) return is + ": rotations or translations of the rig look wrong";
    if (coverage <= 0.8 || (!is_huge && !is_tiny && size.z() <= kTall_m)) return std::nullopt;
    const std::string mistake =
        explain(likely_length_mistakes(size.z(), kPersonHeight, 1.0), kPersonHeight);
    return fmt::format("{}: {}{}{}",
                       is,
                       is_tiny    ? "if that is no hand, "
                       : !is_huge ? "if nobody is that tall, "
                                  : "",
                       mistake.empty() ? "the translations of the rig look like another unit than "
                                         "its key units says (\"m\", \"cm\", \"mm\", \"in\", "
                                         "\"ft\")"
                                       : mistake,
                       is_huge || is_tiny ? ""
                                          : "; or the distance was wrong that was measured for "
                                            "the scale (--distance of calibrate import), or the "
                                            "squares of a chessboard; or the focal lengths are too "
                                            "small");
}

std::optional<std::string> doubt_tall_people(double height_m) {
    if (height_m <= kAlwaysTall_m) return std::nullopt;
    return fmt::format(
        "people are {:.2f} m tall most of the time: if nobody is, the lengths of the rig are too "
        "large, perhaps squares of a chessboard that were said too large: measure the distance "
        "between two cameras and import the calibration again with --distance CAMERA CAMERA METRES",
        height_m);
}

std::optional<std::string> doubt_small_people(double height_m) {
    if (height_m >= kAlwaysSmall_m) return std::nullopt;
    return fmt::format(
        "nobody is taller than {:.2f} m: children, or people who sit or crouch all the time, are, "
        "and nothing is wrong then; if an adult stood upright, the lengths of the rig are too "
        "short, by a factor of about {:.1f}: check the length of the wand or the squares of the "
        "board, and their unit, in the program that calibrated; or measure the distance between "
        "two cameras and import the calibration again with --distance CAMERA CAMERA METRES",
        height_m,
        kUsual_m / height_m);
}

bool is_small_for_person(const geometry::Aabb& extent, double volume_m3) {
    if (extent.empty()) return false;
    return volume_m3 < kSmallVolume_m3 ||
           (volume_m3 < kFatVolume_m3 && extent.size().maxCoeff() < kSmallExtent_m);
}

std::string doubt_small_hull(const geometry::Aabb& extent, double volume_m3) {
    const Eigen::Vector3d size = extent.size();
    return fmt::format(
        "every hull so far is too small for a person, this one is {:.2f} x {:.2f} x {:.2f} m large "
        "and has {:.2g} l: if it is a person, the lengths of the rig are too small, perhaps "
        "squares of a chessboard: measure the distance between two cameras and import the "
        "calibration again with --distance CAMERA CAMERA METRES, or correct the key units",
        size.x(),
        size.y(),
        size.z(),
        1000.0 * volume_m3);
}

}  // namespace atrium::rig_check
