#include "world_server/physics/soft/soft_object.hpp"

#include "world_server/physics/soft/soft_mesh.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace atrium::physics {
namespace {

constexpr double kMinSoftSizeM = 0.01;
constexpr double kMaxSoftSizeM = 20.0;
constexpr float kMaxStart_m = 1000.0F;

bool is_within(double value, double min, double max) { return value >= min && value <= max; }

// Whole centimetres with which the object has few enough nodes.
double least_spacing_m(SoftObject object) {
    for (int cm = 1; cm <= 100; ++cm) {
        object.spacing_m = 0.01 * cm;
        if (count_soft_nodes(object) <= kMaxSoftNodes) break;
    }
    return object.spacing_m;
}

std::optional<ObjectProblem> find_size_problem(const SoftObject& object) {
    const Eigen::Vector3d& s = object.size_m;
    if (object.shape == SoftShape::kModel) {
        if (object.model.vertices.size() > kMaxSoftNodes || object.model.empty()) {
            return ObjectProblem{"model", "must have 4 to 1500 vertices"};
        }
        for (const Eigen::Vector3d& v : object.model.vertices) {
            if (!(v.cwiseAbs().maxCoeff() <= kMaxSoftSizeM)) {
                return ObjectProblem{"scale",
                                     fmt::format("must make the model reach at most {} m from its "
                                                 "origin, as a finite number",
                                                 kMaxSoftSizeM)};
            }
        }
        const geometry::MeshReport report = geometry::inspect(object.model);
        if (!report.manifold) {
            return ObjectProblem{"model",
                                 "must be closed, without holes, each edge shared by two triangles "
                                 "that face the same way"};
        }
        if (!(report.volume_m3 > 0.0))
            return ObjectProblem{"model", "must face outwards: it faces inwards, flip its normals"};
        if (report.num_components != 1)
            return ObjectProblem{"model", "must be one closed surface, not several"};
        if ((geometry::bounds(object.model).size().array() < kMinSoftSizeM).any()) {
            return ObjectProblem{"scale", "must make the model at least 0.01 m along each axis"};
        }
        return std::nullopt;
    }
    // cloth and rope may be thinner
    const bool is_flat = object.shape == SoftShape::kCloth;
    const bool is_rope = object.shape == SoftShape::kRope;
    const double least_y = is_rope ? 0.002 : kMinSoftSizeM;
    const double least_z = is_flat ? 0.001 : kMinSoftSizeM;
    if (!is_within(s.x(), kMinSoftSizeM, kMaxSoftSizeM) ||
        !is_within(s.y(), least_y, kMaxSoftSizeM) || !is_within(s.z(), least_z, kMaxSoftSizeM)) {
        return ObjectProblem{"size_m",
                             "must be 0.01 m to 20 m (the diameter of a rope from 0.002 m, the "
                             "thickness of a cloth from 0.001 m)"};
    }
    if (is_rope && s.z() > s.x()) {
        return ObjectProblem{"span_m", "must not exceed the length of the rope"};
    }
    if (object.span_m && (!is_flat || !is_within(*object.span_m, kMinSoftSizeM, s.x()))) {
        return ObjectProblem{
            "span_m", "must be 0.01 m to the width of the cloth, the first number of size_m"};
    }
    if ((is_flat && s.z() > 0.1) || (is_rope && s.y() > 0.2)) {
        return ObjectProblem{is_rope ? "diameter_m" : "thickness_m",
                             is_rope ? "must be at most 0.2 m" : "must be at most 0.1 m"};
    }
    if (!is_within(object.spacing_m, 0.01, 1.0)) {
        return ObjectProblem{"spacing_m", "must be 0.01 m to 1 m"};
    }
    if (count_soft_nodes(object) > kMaxSoftNodes) {
        return ObjectProblem{"spacing_m",
                             fmt::format("must be at least {:.2f} m, for at most {} nodes",
                                         least_spacing_m(object),
                                         kMaxSoftNodes)};
    }
    return std::nullopt;
}

std::optional<ObjectProblem> find_pin_problem(const SoftObject& object) {
    for (const SoftPin& pin : object.pins) {
        if (!pin.point.allFinite()) return ObjectProblem{"pin_points_m", "must be finite"};
        if (pin.place == PinPlace::kPoint || object.shape == SoftShape::kCloth) continue;
        const bool is_end = pin.place == PinPlace::kLeft || pin.place == PinPlace::kRight;
        if (object.shape != SoftShape::kRope || !is_end) {
            return ObjectProblem{"pins",
                                 "must be edges or corners of a cloth, ends of a rope, or points"};
        }
    }
    return std::nullopt;
}

}  // namespace

double volume_m3(const SoftObject& object) {
    const Eigen::Vector3d& s = object.size_m;
    switch (object.shape) {
        case SoftShape::kRope:
            return std::numbers::pi / 4.0 * s.y() * s.y() * s.x();
        case SoftShape::kBall:
            return std::numbers::pi / 6.0 * s.prod();
        case SoftShape::kModel:
            return geometry::volume_m3(object.model);
        case SoftShape::kCloth:
        case SoftShape::kBox:
            break;
    }
    return s.prod();
}

Eigen::Vector3d start_place(const SoftObject& object) {
    if (object.start_nodes.empty()) return object.world_from_object.translation;
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (const Eigen::Vector3f& node : object.start_nodes) sum += node.cast<double>();
    return sum / static_cast<double>(object.start_nodes.size());
}

std::optional<ObjectProblem> find_problem(const SoftObject& object) {
    const geometry::RigidTransform& pose = object.world_from_object;
    if (!object.size_m.allFinite()) return ObjectProblem{"size_m", "must be finite"};
    if (!pose.translation.allFinite()) return ObjectProblem{"position_m", "must be finite"};
    // written to reject NaN, like all checks here
    if (!(std::abs(pose.rotation.norm() - 1.0) <= 1e-3)) {
        return ObjectProblem{"rotation", "must be a quaternion of length 1"};
    }
    // before the mass, which may follow from the size
    if (const auto problem = find_size_problem(object)) return problem;
    if (!is_within(object.mass_kg, 0.001, 100.0)) {
        return ObjectProblem{"mass_kg", "must be 0.001 kg to 100 kg"};
    }
    if (!is_within(object.stiffness, 0.0, 1.0)) {
        return ObjectProblem{"stiffness", "must be 0 to 1"};
    }
    if (!is_within(object.damping_hz, 0.0, 100.0)) {
        return ObjectProblem{"damping_hz", "must be 0 to 100"};
    }
    if (!is_within(object.friction, 0.0, 10.0)) {
        return ObjectProblem{"friction", "must be 0 to 10"};
    }
    if (const auto problem = find_pin_problem(object)) return problem;
    if (object.start_nodes.empty()) return std::nullopt;
    const std::size_t num_nodes = make_soft_mesh(object).nodes.size();
    const auto is_far = [](const Eigen::Vector3f& node) {
        return !(node.cwiseAbs().maxCoeff() <= kMaxStart_m);
    };
    if (object.start_nodes.size() != num_nodes || std::ranges::any_of(object.start_nodes, is_far)) {
        return ObjectProblem{
            "nodes_m",
            fmt::format("must be {} numbers: x, y, z of each node; leave it out, and the object "
                        "starts in its shape",
                        3 * num_nodes)};
    }
    return std::nullopt;
}

}  // namespace atrium::physics
