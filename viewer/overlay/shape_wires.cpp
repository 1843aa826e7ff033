#include "viewer/overlay/shape_wires.hpp"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace atrium::viewer {
namespace {

using renderer::Line;

constexpr int kCircleLines = 32;  // a multiple of four
constexpr double kNormalM = 0.3;  // length of a plane's normal
constexpr double kPi = std::numbers::pi;

struct Pen {
    const Eigen::Matrix4d& world_from_object;
    const Eigen::Vector3f& colour;
    std::vector<Line>& lines;

    void line(const Eigen::Vector3d& from, const Eigen::Vector3d& to) const {
        append_line((world_from_object * from.homogeneous()).head<3>(),
                    (world_from_object * to.homogeneous()).head<3>(),
                    colour,
                    lines);
    }
    /// Draws an arc from `centre + a` through `centre + b`; a and b are perpendicular.
    void arc(const Eigen::Vector3d& centre,
             const Eigen::Vector3d& a,
             const Eigen::Vector3d& b,
             int num_quarters) const {
        const int num = num_quarters * kCircleLines / 4;
        const auto at = [&](int i) -> Eigen::Vector3d {
            const double angle = 2.0 * kPi * i / kCircleLines;
            return centre + std::cos(angle) * a + std::sin(angle) * b;
        };
        for (int i = 0; i < num; ++i) line(at(i), at(i + 1));
    }
};

void append_sphere(double radius_m, const Pen& pen) {
    for (int axis = 0; axis < 3; ++axis) {
        pen.arc(Eigen::Vector3d::Zero(),
                radius_m * Eigen::Vector3d::Unit(axis),
                radius_m * Eigen::Vector3d::Unit((axis + 1) % 3),
                4);
    }
}

// Appends two rims `height_m` apart and four lines between them, with half circles at the ends of a
// capsule.
void append_round(double radius_m, double height_m, bool has_caps, const Pen& pen) {
    const Eigen::Vector3d x = radius_m * Eigen::Vector3d::UnitX();
    const Eigen::Vector3d y = radius_m * Eigen::Vector3d::UnitY();
    const Eigen::Vector3d z = radius_m * Eigen::Vector3d::UnitZ();
    const Eigen::Vector3d top(0, 0, 0.5 * height_m);
    for (const double end : {-1.0, 1.0}) {
        pen.arc(end * top, x, y, 4);
        if (!has_caps) continue;
        for (const Eigen::Vector3d& side : {x, y}) pen.arc(end * top, side, end * z, 2);
    }
    for (const Eigen::Vector3d& side : {x, y}) {
        for (const double sign : {-1.0, 1.0}) pen.line(sign * side - top, sign * side + top);
    }
}

void append_plane(const Eigen::Vector3d& size_m, const Pen& pen) {
    append_box(pen.world_from_object, {size_m.x(), size_m.y(), 0.0}, pen.colour, pen.lines);
    pen.line(Eigen::Vector3d::Zero(), kNormalM * Eigen::Vector3d::UnitZ());
}

}  // namespace

void append_line(const Eigen::Vector3d& from,
                 const Eigen::Vector3d& to,
                 const Eigen::Vector3f& colour,
                 std::vector<Line>& lines) {
    lines.push_back({{from.cast<float>(), colour}, {to.cast<float>(), colour}});
}

void append_box(const Eigen::Matrix4d& world_from_box,
                const Eigen::Vector3d& size_m,
                const Eigen::Vector3f& colour,
                std::vector<Line>& lines) {
    const auto corner = [&](int index) -> Eigen::Vector3d {
        const Eigen::Vector3d signs((index & 1) != 0 ? 0.5 : -0.5,
                                    (index & 2) != 0 ? 0.5 : -0.5,
                                    (index & 4) != 0 ? 0.5 : -0.5);
        return (world_from_box * signs.cwiseProduct(size_m).homogeneous()).head<3>();
    };
    for (int index = 0; index < 8; ++index) {
        for (const int axis : {1, 2, 4}) {
            if ((index & axis) == 0)
                append_line(corner(index), corner(index | axis), colour, lines);
        }
    }
}

void append_shape(const bus::SceneObject& object,
                  const Eigen::Matrix4d& world_from_object,
                  const Eigen::Vector3f& colour,
                  std::vector<Line>& lines) {
    const Pen pen{world_from_object, colour, lines};
    const Eigen::Vector3d& size = object.size_m;
    switch (object.shape) {
        case bus::Shape::kSphere:
            return append_sphere(0.5 * size.x(), pen);
        case bus::Shape::kCylinder:
            return append_round(0.5 * size.x(), size.z(), /*has_caps=*/false, pen);
        case bus::Shape::kCapsule:
            return append_round(0.5 * size.x(), std::max(0.0, size.z() - size.x()), true, pen);
        case bus::Shape::kPlane:
            return append_plane(size, pen);
        case bus::Shape::kBox:
        case bus::Shape::kConvex:
        case bus::Shape::kCompound:
            return append_box(world_from_object, size, colour, lines);
        case bus::Shape::kSoft:
            return;
    }
}

}  // namespace atrium::viewer
