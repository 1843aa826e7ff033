#pragma once

#include "core/geometry/pinhole_camera.hpp"
#include "tools/calibrate/judge/reading.hpp"

#include <map>
#include <optional>
#include <string>
#include <vector>

namespace atrium::calibrate {

/// Largest spread of a camera that stands still, in a good solution of COLMAP.
inline constexpr double kStillSpread = 0.01;

/// One camera as another program's file describes it, except that its intrinsics already follow
/// our conventions: pixel centres at integers, distortion k1, k2, p1, p2, k3.
struct ForeignCamera {
    std::string name;
    geometry::PinholeCamera lens;  // width 0: the file does not say
    bool has_lens = false;
    std::optional<ForeignPose> pose;
    std::size_t num_images = 1;   // of COLMAP; `pose` is that of the first
    double spread = 0.0;          // of their places, as a share of the rig's size
    bool is_for_markers = false;  // by its model; such a camera may still have pictures
    std::string original = {};    // name in the file if `name` is another one, else empty
    int view_rotation_deg = 0;    // 90 or 270: QTM turns the pictures that it exports so
    std::string model = {};       // as its maker calls it, for example "Oqus 210c"; or empty

    /// The name that the user knows.
    const std::string& known_name() const { return original.empty() ? name : original; }
};

/// A camera that was carried about while it took pictures, and is no camera of the rig.
struct Walked {
    std::string name;
    std::string problem;  // a sentence, with the cure
};

/// The cameras of one or more files of another program. Lengths are in the unit of the file.
struct ForeignRig {
    std::string format;  // for messages, for example "Qualisys"
    std::vector<ForeignCamera> cameras;
    bool is_sure_of_poses = false;      // the format leaves no choice of `documented`
    bool has_matrix_poses = false;      // of 3x4 or 4x4: never a rotation and a position
    Reading documented;                 // what the format's documentation says of poses
    std::string units;                  // that the format prescribes; empty: none
    bool has_scale = true;              // false: lengths have no unit at all
    bool has_frame = true;              // false: the origin and axes mean nothing
    std::string up;                     // that the format prescribes, for example "+Z"; or empty
    std::vector<std::string> notes;     // what a reader should know, as sentences
    std::vector<std::string> checks;    // assumptions, with the cure
    std::vector<std::string> problems;  // cameras that are left out, with the cure
    std::vector<Walked> walked = {};    // the same, of cameras that were carried about
    /// Other cameras of the files that are left out, by name in the file, and why, with the cure.
    /// Empty: the user wants it so, or `problems` says why.
    std::map<std::string, std::string> left_out = {};
};

}  // namespace atrium::calibrate
