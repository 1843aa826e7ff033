#include "tools/calibrate/floor/floor_frame.hpp"

#include "core/geometry/alignment.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace atrium::calibrate {
namespace {

constexpr double kLeastSpread_m = 0.03;  // RMS across the longest direction of the marks
constexpr double kLeastApart_m = 0.05;

}  // namespace

Expected<FloorFrame> floor_frame(const FloorMarks& marks,
                                 const std::vector<geometry::CalibratedCamera>& cameras,
                                 const FloorOptions& options) {
    if (marks.on_floor.size() < 3)
        return make_error(ErrorKind::kInvalidData,
                          fmt::format("{} places on the floor are known; a floor needs 3 or more",
                                      marks.on_floor.size()));
    const auto n = static_cast<double>(marks.on_floor.size());
    Eigen::Vector3d middle = Eigen::Vector3d::Zero();
    for (const Eigen::Vector3d& mark : marks.on_floor) middle += mark / n;
    Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
    for (const Eigen::Vector3d& mark : marks.on_floor)
        spread += (mark - middle) * (mark - middle).transpose() / n;
    const geometry::PrincipalAxes axes = geometry::principal_axes(spread);
    if (std::sqrt(std::max(0.0, axes.values[1])) < kLeastSpread_m)
        return make_error(ErrorKind::kInvalidData,
                          "the places on the floor lie on a line, or within a few centimetres: "
                          "spread them over the floor, with a right angle between them");
    FloorFrame frame;
    frame.rms_m = std::sqrt(std::max(0.0, axes.values[0]));
    Eigen::Vector3d up = axes.axes.col(0);
    const auto on_plane = [&](const Eigen::Vector3d& point) -> Eigen::Vector3d {
        return point - up * up.dot(point - middle);
    };
    const Eigen::Vector3d origin = on_plane(marks.origin);
    const Eigen::Vector3d along = on_plane(marks.on_x) - origin;
    if (along.norm() < kLeastApart_m)
        return make_error(ErrorKind::kInvalidData,
                          "the origin and the mark on +X are less than 5 cm apart");
    const auto num_above = [&](const Eigen::Vector3d& direction) {
        return std::ranges::count_if(cameras, [&](const geometry::CalibratedCamera& camera) {
            return direction.dot(camera.centre_site() - origin) > 0.0;
        });
    };
    if (marks.has_y_side) {
        const double side = up.cross(along).dot(on_plane(marks.on_y_side) - origin);
        if (std::abs(side) < kLeastApart_m * along.norm())
            return make_error(ErrorKind::kInvalidData,
                              "the mark on the side of +Y lies on the line through the origin and "
                              "the mark on +X: put it beside that line");
        if (side < 0.0) up = -up;
    } else if (num_above(-up) > num_above(up)) {
        up = -up;
    }
    frame.num_below = cameras.size() - static_cast<std::size_t>(num_above(up));
    if (2 * frame.num_below >= cameras.size())
        return make_error(
            ErrorKind::kInvalidData,
            fmt::format("{} of {} cameras would be below the floor: the marks, or the rig, are "
                        "mirrored or upside down. Seen from above, +Y is counter-clockwise from "
                        "+X: are two marks swapped?",
                        frame.num_below,
                        cameras.size()));
    const Eigen::Vector3d x = Eigen::AngleAxisd(-options.yaw_rad, up) * along.normalized();
    Eigen::Matrix3d rig_from_floor;
    rig_from_floor << x, up.cross(x), up;
    frame.rig_from_floor.rotation = Eigen::Quaterniond(rig_from_floor).normalized();
    frame.rig_from_floor.translation = origin - options.thickness_m * up;
    return frame;
}

}  // namespace atrium::calibrate
