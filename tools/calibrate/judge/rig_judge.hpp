#pragma once

#include "core/geometry/pinhole_camera.hpp"
#include "tools/calibrate/judge/reading.hpp"

#include <Eigen/Core>

#include <span>
#include <string>
#include <vector>

/// Judges a rig by its geometry alone, without pictures: cameras of a room look at one place in
/// front of them, from some metres, and are level. Pure functions.
namespace atrium::calibrate {

/// How well cameras fit into a room. All lengths are in the unit of the cameras.
struct Convergence {
    Eigen::Vector3d point = Eigen::Vector3d::Zero();  // nearest to all optical axes
    std::size_t num_looking = 0;   // cameras that have the point before them, near their axis
    double off_axis = 0.0;         // mean angle [rad] of the point off the cameras' axes
    double spread = 0.0;           // 0: all axes are parallel, 0.5: cameras all around
    double tilt = 0.0;             // mean deviation from level pictures, as a sine
    double median_distance = 0.0;  // from the cameras to the point
    double score = 0.0;            // larger is better
};
Convergence measure_convergence(std::span<const geometry::CalibratedCamera> cameras);

/// Says of each camera whether it looks at the place that most cameras look at.
std::vector<bool> look_at_one_place(std::span<const geometry::CalibratedCamera> cameras);

struct ReadingChoice {
    Reading reading;
    Convergence convergence;             // as read
    bool is_documented = true;           // false: the cameras prove another reading
    std::vector<Reading> also_possible;  // fit about as well as `reading`
};
/// Finds the reading in which the cameras look at one place: `documented`, unless another one is
/// clearly better. `cameras` give the lenses, `poses` belong to them. `are_matrices`: each pose is
/// one matrix, so that its vector is no position beside a rotation into the camera.
ReadingChoice choose_reading(std::span<const geometry::CalibratedCamera> cameras,
                             std::span<const ForeignPose> poses,
                             const Reading& documented,
                             bool are_matrices = false);

struct UnitChoice {
    double metres = 0.0;        // of one unit; 0: no unit makes the cameras fit into a room
    std::string name;           // "mm"
    std::string also_possible;  // another unit that makes a usual room as well, or empty
};
/// Finds the unit (m, cm or mm) in which cameras at `median_distance` from what they look at fit
/// into a room. `prescribed` wins if it fits; empty: none.
UnitChoice choose_unit(double median_distance, const std::string& prescribed);

/// Three digits without an exponent: "4410", "0.97", "0.0000441".
std::string length_text(double length);

/// Whether cameras stand so near to what they look at that no person fits between them.
bool is_small_room(double distance_m);

/// A doubt about a unit that was found out, if it makes cameras stand so near, `distance_m`, to
/// what they look at that no person fits between them; empty if it is usual. `from`, `to`: two
/// cameras.
std::string doubt_small_room(double distance_m, const std::string& from, const std::string& to);

/// The same doubt about a distance that the user measured from one camera to another.
std::string doubt_small_measured(double distance_m, const std::string& from, const std::string& to);

/// A problem if cameras stand `distance_m` from what they look at because the user measured
/// `metres` from one camera to another: the likely cause, and the cure. Empty if it is usual.
std::string doubt_measured(double distance_m,
                           const std::string& from,
                           const std::string& to,
                           double metres);

/// If cameras at `median_distance`, in `unit`, stand unusually near or far, returns the unit that
/// makes the most usual room of it; empty if the distance is usual, or no unit makes it so.
std::string better_unit(double median_distance, const std::string& unit);

/// Metres of "m", "cm", "mm", "in" or "ft"; 0 for anything else.
double metres_of(const std::string& unit);

/// Unit vector of "+X", "-X", ... "-Z" (or "X"); the zero vector for anything else.
Eigen::Vector3d axis_vector(const std::string& name);

/// Unit vector of an axis, as `axis_vector`, or of three numbers, as "0.1,-0.98,0.2"; the zero
/// vector for anything else.
Eigen::Vector3d up_vector(const std::string& text);

/// The rotation that takes `up` to +Z. Keeps X where it can.
Eigen::Quaterniond upright_from(const Eigen::Vector3d& up);

}  // namespace atrium::calibrate
