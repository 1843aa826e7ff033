#include "viewer/overlay/edit_shapes.hpp"

#include "viewer/overlay/label_layout.hpp"
#include "viewer/overlay/text_picture.hpp"

#include <Eigen/Geometry>

#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <tuple>
#include <utility>

namespace atrium::viewer {
namespace {

using renderer::Triangle;

constexpr double kOutlineWidth = 0.0045;  // shares of the picture's height
constexpr double kHandleWidth = 0.006;
constexpr double kHeadLength = 0.035;
constexpr double kHeadWidth = 0.022;
constexpr double kMiddleWidth = 0.02;
constexpr int kRingParts = 64;
constexpr std::size_t kMaxFaces = 60'000;  // of a model; a larger one gets the outline of its box
const Eigen::Vector3f kOutline{1.0f, 0.62f, 0.1f};
const Eigen::Vector3f kActive{1.0f, 0.95f, 0.35f};
const Eigen::Vector3f kMiddle{0.9f, 0.9f, 0.9f};
const std::array<Eigen::Vector3f, 3> kAxes{
    Eigen::Vector3f{0.93f, 0.25f, 0.28f}, {0.45f, 0.8f, 0.2f}, {0.25f, 0.5f, 0.98f}};

// Draws bands and heads that face the eye.
class Brush {
public:
    Brush(const renderer::EyeView& eye, std::vector<Triangle>& triangles)
        : eye_(eye), eye_world_(eye.eye_world()), triangles_(triangles) {}

    /// A band of that width [share of the height] from a to b; the ends may differ in width.
    void band(const Eigen::Vector3d& a,
              const Eigen::Vector3d& b,
              double width_a,
              double width_b,
              const Eigen::Vector3f& colour) {
        const Eigen::Vector3d way = b - a;
        const Eigen::Vector3d side = way.cross(0.5 * (a + b) - eye_world_).normalized();
        if (!side.allFinite()) return;
        const Eigen::Vector3d half_a = 0.5 * metres(width_a, a) * side;
        const Eigen::Vector3d half_b = 0.5 * metres(width_b, b) * side;
        add(a - half_a, a + half_a, b + half_b, colour);
        add(a - half_a, b + half_b, b - half_b, colour);
    }
    /// A band with round-looking ends, so that the corners of an outline close.
    void stroke(const Eigen::Vector3d& a,
                const Eigen::Vector3d& b,
                double width,
                const Eigen::Vector3f& colour) {
        const double length = (b - a).norm();
        if (length < 1e-9) return;
        const Eigen::Vector3d more = (0.35 * metres(width, a) / length) * (b - a);
        band(a - more, b + more, width, width, colour);
    }
    void square(const Eigen::Vector3d& at, double width, const Eigen::Vector3f& colour) {
        const double half_m = 0.5 * metres(width, at);
        const Eigen::Vector3d x = half_m * eye_.view_from_world.row(0).head<3>().transpose();
        const Eigen::Vector3d y = half_m * eye_.view_from_world.row(1).head<3>().transpose();
        add(at - x - y, at + x - y, at + x + y, colour);
        add(at - x - y, at + x + y, at - x + y, colour);
    }
    double metres(double share, const Eigen::Vector3d& at) const {
        const double depth_m =
            -(eye_.view_from_world.row(2).head<3>().dot(at) + eye_.view_from_world(2, 3));
        return 2.0 * share * std::max(depth_m, 0.1) / eye_.clip_from_view(1, 1);
    }
    const Eigen::Vector3d& eye_world() const { return eye_world_; }

private:
    void add(const Eigen::Vector3d& a,
             const Eigen::Vector3d& b,
             const Eigen::Vector3d& c,
             const Eigen::Vector3f& colour) {
        using End = renderer::Line::End;
        triangles_.push_back({{End{a.cast<float>(), colour},
                               End{b.cast<float>(), colour},
                               End{c.cast<float>(), colour}}});
    }

    const renderer::EyeView& eye_;
    Eigen::Vector3d eye_world_;
    std::vector<Triangle>& triangles_;
};

renderer::ShapeKind shape_kind_of(bus::Shape shape) {
    switch (shape) {
        case bus::Shape::kSphere:
            return renderer::ShapeKind::kSphere;
        case bus::Shape::kCylinder:
            return renderer::ShapeKind::kCylinder;
        case bus::Shape::kCapsule:
            return renderer::ShapeKind::kCapsule;
        case bus::Shape::kPlane:
            return renderer::ShapeKind::kPlane;
        default:
            return renderer::ShapeKind::kBox;
    }
}

void append_handles(const EditView& edit, const renderer::EyeView& eye, Brush& brush) {
    const EditHandles& handles = edit.handles;
    const Eigen::Vector3d& at = handles.world_from_object.translation;
    const double length_m = handles.metres(EditHandles::kLength, eye);
    const double radius_m = handles.metres(EditHandles::kRadius, eye);
    const double head_m = handles.metres(kHeadLength, eye);
    for (Handle handle = 0; handle < 3; ++handle) {
        const Eigen::Vector3d axis = handles.axis(handle);
        const bool is_active = edit.active == handle;
        if (edit.is_dragging && !is_active) continue;
        const Eigen::Vector3f& colour =
            is_active ? kActive : kAxes[static_cast<std::size_t>(handle)];
        if (handles.mode == HandleMode::kMove) {
            const Eigen::Vector3d neck = at + (length_m - head_m) * axis;
            brush.band(at, neck, kHandleWidth, kHandleWidth, colour);
            brush.band(neck, at + length_m * axis, kHeadWidth, 0.0, colour);
            continue;
        }
        for (int i = 0; i < kRingParts; ++i) {
            const double step = 2.0 * std::numbers::pi / kRingParts;
            const Eigen::Vector3d from = handles.ring_point(handle, i * step, radius_m);
            const Eigen::Vector3d to = handles.ring_point(handle, (i + 1) * step, radius_m);
            // the far half is thinner
            const bool is_far = (from - at).dot(brush.eye_world() - at) < 0.0;
            const double width = is_far ? 0.4 * kHandleWidth : kHandleWidth;
            brush.stroke(from, to, width, colour);
        }
    }
    if (handles.mode == HandleMode::kMove && (!edit.is_dragging || edit.active == kMiddleHandle))
        brush.square(at, kMiddleWidth, edit.active == kMiddleHandle ? kActive : kMiddle);
}

}  // namespace

// The edges of a mesh with the normals of the faces beside them.
struct EditShapes::Silhouette {
    struct Edge {
        Eigen::Vector3f from;
        Eigen::Vector3f to;
        Eigen::Vector3f left = Eigen::Vector3f::Zero();  // normals; zero: no face
        Eigen::Vector3f right = Eigen::Vector3f::Zero();
    };
    std::shared_ptr<const renderer::ShapeMesh> mesh;  // of these edges
    bus::Shape shape = bus::Shape::kBox;
    Eigen::Vector3d size_m = Eigen::Vector3d::Zero();
    std::vector<Edge> edges;

    void build(const renderer::ShapeMesh& of);
    void append(const geometry::RigidTransform& world_from_object, Brush& brush) const;
};

void EditShapes::Silhouette::build(const renderer::ShapeMesh& of) {
    // corners are repeated per face: join them by place
    std::map<std::tuple<float, float, float>, std::uint32_t> places;
    std::vector<std::uint32_t> place_of;
    for (const auto& corner : of.corners) {
        const auto round = [](float x) { return std::round(x * 1e5f) / 1e5f + 0.0f; };
        const Eigen::Vector3f& p = corner.position_object;
        place_of.push_back(places
                               .try_emplace({round(p.x()), round(p.y()), round(p.z())},
                                            static_cast<std::uint32_t>(places.size()))
                               .first->second);
    }
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::size_t> known;
    for (std::size_t i = 0; i + 2 < of.indices.size(); i += 3) {
        const std::array<std::uint32_t, 3> t{of.indices[i], of.indices[i + 1], of.indices[i + 2]};
        const auto at = [&](int k) -> const Eigen::Vector3f& {
            return of.corners[t[static_cast<std::size_t>(k % 3)]].position_object;
        };
        // at a pole, triangles without an area meet
        const auto place = [&](std::size_t k) { return place_of[t[k]]; };
        if (place(0) == place(1) || place(1) == place(2) || place(2) == place(0)) continue;
        const Eigen::Vector3f normal = (at(1) - at(0)).cross(at(2) - at(0));
        if (!(normal.norm() > 0.0f)) continue;
        for (int k = 0; k < 3; ++k) {
            const std::uint32_t a = place_of[t[static_cast<std::size_t>(k)]];
            const std::uint32_t b = place_of[t[static_cast<std::size_t>((k + 1) % 3)]];
            const auto [entry, is_new] = known.try_emplace(std::minmax(a, b), edges.size());
            if (is_new)
                edges.push_back({at(k), at(k + 1), normal});
            else
                edges[entry->second].right = normal;
        }
    }
}

// Appends the edges between faces that look at the eye and faces that look away.
void EditShapes::Silhouette::append(const geometry::RigidTransform& world_from_object,
                                    Brush& brush) const {
    const Eigen::Vector3f eye =
        (world_from_object.inverse() * brush.eye_world()).template cast<float>();
    for (const Edge& edge : edges) {
        const Eigen::Vector3f way = eye - edge.from;
        const bool is_left = edge.left.dot(way) > 0.0f;
        const bool is_right = edge.right.dot(way) > 0.0f;
        const bool is_open = edge.right.isZero();
        if (is_left == is_right && !is_open) continue;
        brush.stroke(world_from_object * edge.from.cast<double>(),
                     world_from_object * edge.to.cast<double>(),
                     kOutlineWidth,
                     kOutline);
    }
}

void EditShapes::append_readout(const EditView& edit,
                                const renderer::EyeView& eye,
                                std::vector<renderer::Label>& labels) {
    if (edit.readout.empty()) return;
    if (drawn_readout_ != edit.readout) {
        drawn_readout_ = edit.readout;
        readout_ = draw_text(edit.readout);
    }
    renderer::Label label;
    label.picture = readout_;
    // above the handles
    label.at_world = edit.handles.world_from_object.translation +
                     edit.handles.metres(EditHandles::kRadius, eye) *
                         eye.view_from_world.row(1).head<3>().transpose();
    label.height = 0.045;
    keep_in_picture(label, eye);
    labels.push_back(label);
}

void EditShapes::append(const EditView& edit,
                        const std::shared_ptr<const renderer::ShapeMesh>& mesh,
                        const std::vector<Eigen::Vector3f>* soft_nodes,
                        const renderer::EyeView& eye,
                        std::vector<renderer::Triangle>& triangles,
                        std::vector<renderer::Label>& labels) {
    if (!edit.selected) {
        silhouette_.reset();
        return;
    }
    const bus::SceneObject& object = *edit.selected;
    Brush brush(eye, triangles);
    geometry::RigidTransform pose = edit.pose;
    Eigen::Vector3d size_m = object.size_m;
    if (soft_nodes != nullptr && !soft_nodes->empty()) {
        geometry::Aabb bounds;
        for (const Eigen::Vector3f& node : *soft_nodes) bounds.add(node.cast<double>());
        pose = {Eigen::Quaterniond::Identity(), 0.5 * (bounds.min + bounds.max)};
        size_m = bounds.size();
    }
    const bool is_known = silhouette_ && silhouette_->mesh == mesh &&
                          silhouette_->shape == object.shape && silhouette_->size_m == size_m;
    if (!is_known) {
        auto made = std::make_shared<Silhouette>();
        made->mesh = mesh;
        made->shape = object.shape;
        made->size_m = size_m;
        const bool has_mesh = mesh != nullptr && mesh->indices.size() <= 3 * kMaxFaces;
        made->build(has_mesh
                        ? *mesh
                        : renderer::make_shape(shape_kind_of(object.shape), size_m.cwiseMax(1e-3)));
        silhouette_ = std::move(made);
    }
    silhouette_->append(pose, brush);
    if (soft_nodes != nullptr) return;
    append_handles(edit, eye, brush);
    append_readout(edit, eye, labels);
}

}  // namespace atrium::viewer
