#include "tools/calibrate/judge/rig_judge.hpp"

#include "core/base/median.hpp"
#include "core/geometry/alignment.hpp"
#include "tools/calibrate/judge/choose_up.hpp"

#include <Eigen/LU>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>

namespace atrium::calibrate {
namespace {

using Cameras = std::span<const geometry::CalibratedCamera>;

// A camera looks at a point within this angle of its axis: half of a wide view.
constexpr double kLooksWithin_rad = 0.7;
// Another reading must be better than the documented one by this much to win, and is said to be
// possible too if it is not worse than this.
constexpr double kClearlyBetter = 0.3;
constexpr double kAboutAsGood = 0.12;
constexpr double kFarMoreExact = 0.3;
// Distances [m] from a camera to what it looks at, in rooms; and the usual one.
constexpr double kNearest_m = 0.3;
constexpr double kFarthest_m = 40.0;
constexpr double kUsual_m = 3.0;
constexpr double kUsualNearest_m = 0.8;
constexpr double kUsualFarthest_m = 12.0;
constexpr double kSmallForPerson_m = 1.5;

Eigen::Vector3d axis_site(const geometry::CalibratedCamera& camera, int axis) {
    return camera.camera_from_site.rotation.conjugate() * Eigen::Vector3d::Unit(axis);
}

Eigen::Vector3d nearest_to_axes(Cameras cameras) {
    Eigen::Matrix3d a = Eigen::Matrix3d::Identity() * 1e-9;
    Eigen::Vector3d b = Eigen::Vector3d::Zero();
    for (const auto& camera : cameras) {
        const Eigen::Vector3d axis = axis_site(camera, 2);
        const Eigen::Matrix3d off_axis = Eigen::Matrix3d::Identity() - axis * axis.transpose();
        a += off_axis;
        b += off_axis * camera.centre_site();
    }
    return a.inverse() * b;
}

}  // namespace

Convergence measure_convergence(Cameras cameras) {
    Convergence result;
    if (cameras.empty()) return result;
    result.point = nearest_to_axes(cameras);
    Eigen::Matrix3d directions = Eigen::Matrix3d::Zero();
    std::vector<double> distances;
    for (const auto& camera : cameras) {
        const Eigen::Vector3d axis = axis_site(camera, 2);
        const Eigen::Vector3d to_point = result.point - camera.centre_site();
        distances.push_back(to_point.norm());
        directions += axis * axis.transpose() / static_cast<double>(cameras.size());
        if (axis.dot(to_point) > std::cos(kLooksWithin_rad) * to_point.norm()) ++result.num_looking;
        result.off_axis += std::atan2(axis.cross(to_point).norm(), axis.dot(to_point)) /
                           static_cast<double>(cameras.size());
    }
    result.median_distance = median_of(distances);
    const double along = geometry::principal_axes(directions).values[2];
    result.spread = std::max(0.0, 1.0 - along);
    result.tilt = choose_up(cameras).mean_tilt;
    // a place far nearer to some cameras than to others is no room
    const double nearest = *std::ranges::min_element(distances);
    const bool is_even = nearest > 0.1 * result.median_distance && result.median_distance > 0.0;
    result.score = (is_even ? 1.0 : 0.5) * static_cast<double>(result.num_looking) /
                       static_cast<double>(cameras.size()) +
                   0.8 * std::min(1.0, result.spread / 0.2) -
                   0.6 * std::min(1.0, result.tilt / 0.2);
    return result;
}

std::vector<bool> look_at_one_place(Cameras cameras) {
    const auto looks_at = [&](const Eigen::Vector3d& point) {
        std::vector<bool> looking;
        for (const auto& camera : cameras) {
            const Eigen::Vector3d to_point = point - camera.centre_site();
            looking.push_back(axis_site(camera, 2).dot(to_point) >
                              std::cos(kLooksWithin_rad) * to_point.norm());
        }
        return looking;
    };
    // others pull the point to them, so it is found again without them
    const std::vector<bool> first = looks_at(nearest_to_axes(cameras));
    std::vector<geometry::CalibratedCamera> most;
    for (std::size_t i = 0; i < cameras.size(); ++i)
        if (first[i]) most.push_back(cameras[i]);
    if (most.size() < 2) return first;
    const std::vector<bool> second = looks_at(nearest_to_axes(most));
    return std::ranges::count(second, true) < std::ranges::count(first, true) ? first : second;
}

ReadingChoice choose_reading(Cameras cameras,
                             std::span<const ForeignPose> poses,
                             const Reading& documented,
                             bool are_matrices) {
    std::vector<geometry::CalibratedCamera> read(cameras.begin(), cameras.end());
    std::vector<Convergence> tried;
    for (const Reading& reading : kReadings) {
        for (std::size_t i = 0; i < read.size(); ++i)
            read[i].camera_from_site = camera_from_site(poses[i], reading);
        tried.push_back(measure_convergence(read));
    }
    const auto index_of = [](const Reading& reading) {
        return static_cast<std::size_t>(std::ranges::find(kReadings, reading) - kReadings.begin());
    };
    const std::size_t as_written = index_of(documented);
    const auto is_possible = [&](std::size_t i) {
        return i == as_written || !are_matrices ||
               (kReadings[i].pose != Reading::Pose::kRotationAndPosition &&
                kReadings[i].pose != Reading::Pose::kTransposed);
    };
    const auto is_transposed = [&](std::size_t i) {
        return i != as_written && kReadings[i].pose == Reading::Pose::kTransposed;
    };
    // Rings of cameras often look at one place in this reading, too: it must be level and exact.
    const auto is_better_transposed = [&](std::size_t i, std::size_t other, double needed) {
        const double better = tried[i].score - tried[other].score;
        const double off_axis = tried[i].off_axis / std::max(tried[other].off_axis, 1e-9);
        return cameras.size() > 2 && tried[i].num_looking == cameras.size() &&
               (better > 2.0 * kClearlyBetter || (better > needed && off_axis < 1.0) ||
                (better > 0.0 && off_axis < kFarMoreExact));
    };
    std::size_t best = as_written;
    for (std::size_t i = 0; i < kReadings.size(); ++i) {
        // the documented reading has an advantage; the others have none over each other
        const double needed = best == as_written ? kClearlyBetter : 0.0;
        const bool is_better = is_transposed(i)
                                   ? is_better_transposed(i, best, 0.5 * kClearlyBetter)
                                   : tried[i].score > tried[best].score + needed;
        if (is_possible(i) && is_better && tried[i].num_looking > 1) best = i;
    }
    ReadingChoice choice{kReadings[best], tried[best], best == as_written, {}};
    for (std::size_t i = 0; i < kReadings.size(); ++i) {
        const bool is_as_good = is_transposed(i)
                                    ? is_better_transposed(i, best, 0.0)
                                    : tried[i].score > tried[best].score - kAboutAsGood;
        if (i != best && is_possible(i) && is_as_good) choice.also_possible.push_back(kReadings[i]);
    }
    return choice;
}

double metres_of(const std::string& unit) {
    if (unit == "m") return 1.0;
    if (unit == "cm") return 0.01;
    if (unit == "mm") return 0.001;
    if (unit == "in") return 0.0254;
    if (unit == "ft") return 0.3048;
    return 0.0;
}

namespace {

bool is_usual_distance(double distance_m) {
    return distance_m >= kUsualNearest_m && distance_m <= kUsualFarthest_m;
}

// Millimetres come before centimetres, which fewer programs write, and inches and feet are rare.
double strangeness(double median_distance, const std::string& unit) {
    return std::abs(std::log(median_distance * metres_of(unit) / kUsual_m)) +
           (unit == "cm"                   ? 0.5
            : unit == "in" || unit == "ft" ? 1.0
                                           : 0.0);
}

}  // namespace

std::string better_unit(double median_distance, const std::string& unit) {
    const double distance_m = median_distance * metres_of(unit);
    if (is_usual_distance(distance_m)) return {};
    const bool is_hall = distance_m > kNearest_m && distance_m < kFarthest_m;
    std::string best;
    for (const std::string other : {"m", "mm", "cm", "in", "ft"}) {
        if (other == unit || !is_usual_distance(median_distance * metres_of(other))) continue;
        // a hall in metres would be a room in feet
        if (is_hall && (other == "in" || other == "ft")) continue;
        if (best.empty() ||
            strangeness(median_distance, other) < strangeness(median_distance, best))
            best = other;
    }
    return best;
}

std::string length_text(double length) {
    if (!(length > 0.0) || !std::isfinite(length)) return fmt::format("{:.3g}", length);
    const int magnitude = static_cast<int>(std::floor(std::log10(length)));
    if (magnitude >= 3) {
        const double step = std::pow(10.0, magnitude - 2);
        return fmt::format("{:.0f}", std::round(length / step) * step);
    }
    return magnitude < -4 ? fmt::format("{:.{}f}", length, 2 - magnitude)
                          : fmt::format("{:.3g}", length);
}

bool is_small_room(double distance_m) { return distance_m < kSmallForPerson_m; }

std::string doubt_small_room(double distance_m, const std::string& from, const std::string& to) {
    if (!is_small_room(distance_m)) return {};
    return fmt::format(
        "lengths: {} m from the cameras to the place that they look at is small for a person; if "
        "lengths are squares of a chessboard, measure the distance between two cameras: --distance "
        "{} {} METRES",
        length_text(distance_m),
        from,
        to);
}

std::string doubt_small_measured(double distance_m,
                                 const std::string& from,
                                 const std::string& to) {
    if (!is_small_room(distance_m)) return {};
    return fmt::format(
        "lengths: {} m from the cameras to the place that they look at is small for a person; if "
        "the room is larger, measure the distance between {} and {} again: --distance {} {} METRES",
        length_text(distance_m),
        from,
        to,
        from,
        to);
}

std::string doubt_measured(double distance_m,
                           const std::string& from,
                           const std::string& to,
                           double metres) {
    if (is_usual_distance(distance_m)) return {};
    std::string other_unit;
    for (const std::string unit : {"cm", "mm", "in", "ft"}) {
        if (!is_usual_distance(distance_m * metres_of(unit))) continue;
        other_unit = fmt::format(
            "--distance takes metres; if you gave {}, say --distance {} {} {:.4g}; else ",
            unit,
            from,
            to,
            metres * metres_of(unit));
        break;
    }
    return fmt::format(
        "lengths: {} m from the cameras to the place that they look at is unusual; {}measure "
        "the distance between {} and {} again, in metres, if the room is not that {}",
        length_text(distance_m),
        other_unit,
        from,
        to,
        distance_m > kUsual_m ? "large" : "small");
}

UnitChoice choose_unit(double median_distance, const std::string& prescribed) {
    const auto fits = [&](const std::string& unit) {
        const double distance_m = median_distance * metres_of(unit);
        return distance_m >= kNearest_m && distance_m <= kFarthest_m;
    };
    UnitChoice choice;
    std::array<std::string, 3> units{"m", "mm", "cm"};
    std::ranges::sort(
        units, {}, [&](const std::string& unit) { return strangeness(median_distance, unit); });
    for (const std::string& unit : units) {
        if (fits(unit) && choice.name.empty()) choice.name = unit;
    }
    if (!prescribed.empty() && fits(prescribed)) choice.name = prescribed;
    choice.metres = metres_of(choice.name);
    for (const std::string& unit : units) {
        if (unit != choice.name && is_usual_distance(median_distance * metres_of(unit)) &&
            choice.also_possible.empty() && prescribed != choice.name)
            choice.also_possible = unit;
    }
    return choice;
}

Eigen::Vector3d axis_vector(const std::string& name) {
    const std::string letters = name.size() == 1 ? "+" + name : name;
    const std::size_t axis = letters.size() == 2 ? std::string("XYZxyz").find(letters[1]) : 6;
    if (axis >= 6 || (letters[0] != '+' && letters[0] != '-')) return Eigen::Vector3d::Zero();
    return (letters[0] == '+' ? 1.0 : -1.0) * Eigen::Vector3d::Unit(static_cast<int>(axis % 3));
}

Eigen::Vector3d up_vector(const std::string& text) {
    if (const Eigen::Vector3d axis = axis_vector(text); !axis.isZero()) return axis;
    Eigen::Vector3d direction = Eigen::Vector3d::Zero();
    const char* at = text.data();
    const char* const end = text.data() + text.size();
    for (int i = 0; i < 3; ++i) {
        if (i > 0 && (at == end || *at++ != ',')) return Eigen::Vector3d::Zero();
        while (at != end && (*at == ' ' || *at == '+')) ++at;
        const auto [next, failure] = std::from_chars(at, end, direction[i]);
        if (failure != std::errc{} || !(std::abs(direction[i]) <= 1e6))
            return Eigen::Vector3d::Zero();
        at = next;
    }
    if (at != end || direction.norm() < 1e-6) return Eigen::Vector3d::Zero();
    return direction.normalized();
}

Eigen::Quaterniond upright_from(const Eigen::Vector3d& up) {
    // perpendicular to up: the old X, or -Z for a frame with X up
    const Eigen::Vector3d start = std::abs(up.x()) < 0.9
                                      ? Eigen::Vector3d(Eigen::Vector3d::UnitX())
                                      : Eigen::Vector3d(-Eigen::Vector3d::UnitZ());
    const Eigen::Vector3d x = (start - start.dot(up) * up).normalized();
    Eigen::Matrix3d rows;
    rows.row(0) = x;
    rows.row(1) = up.cross(x);
    rows.row(2) = up;
    return Eigen::Quaterniond(rows).normalized();
}

}  // namespace atrium::calibrate
