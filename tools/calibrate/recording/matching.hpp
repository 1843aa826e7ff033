#pragma once

#include "core/base/expected.hpp"
#include "tools/calibrate/recording/shots.hpp"

#include <map>
#include <string>
#include <vector>

/// Finds the pictures of each camera by name.
namespace atrium::calibrate {

inline constexpr int kByName = 70;  // likeness of names, not only of numbers

/// How surely a label is that of a camera: 0 not at all, 50 the same number, 100 the same name.
/// `others` are all labels, `cameras` all cameras: what they have in common says nothing.
int likeness(const std::string& camera,
             const std::string& label,
             const std::vector<std::string>& others,
             const std::vector<std::string>& cameras = {});

/// The name in the calibration, of each camera that is called otherwise in the rig.
using Originals = std::map<std::string, std::string>;

/// The name that the user knows.
const std::string& known_name(const std::string& camera, const Originals& originals);

struct Matches {
    std::map<std::string, Shots> by_camera;
    std::vector<std::string> missing;  // cameras without pictures
};
/// What to do if a camera fits two, for most pictures.
inline constexpr const char* kCureOfTwo =
    "name the folder of one recording, move other pictures away, or give the pictures the names of "
    "the cameras; an empty room is given with --background, masks with --masks";

/// Matches whole names first: a folder or file with the name of exactly one camera, as "hd_00_04"
/// has that of "00_04", belongs to it. The cameras and pictures that are left go by `likeness`.
/// A camera has two names if it is one of `originals`; the one in the calibration goes first.
/// Error kConfiguration, with the names, and `cure`, if a camera fits two, or if two cameras fit
/// one.
Expected<Matches> match_shots(const std::vector<std::string>& cameras,
                              const std::vector<Shots>& shots,
                              const Originals& originals = {},
                              const std::string& cure = kCureOfTwo);

}  // namespace atrium::calibrate
