#include "world_server/description/start_doubts.hpp"

#include "core/geometry/roll_pitch_yaw.hpp"
#include "core/model/model_file.hpp"
#include "world_server/description/hollow_doubts.hpp"
#include "world_server/physics/soft/soft_mesh.hpp"
#include "world_server/physics/start_overlap.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

namespace atrium::world_server {
namespace {

constexpr const char* kEndless =
    ", a plane, which has no end however large it is drawn (a poster or tabletop is a thin box)";

// True if the middle of the object is not above or below what is drawn of a plane.
bool is_beside(const physics::RigidObject& object, const physics::RigidObject& plane) {
    if (plane.shape != physics::ObjectShape::kPlane) return false;
    const Eigen::Vector3d at =
        plane.world_from_object.inverse() * object.world_from_object.translation;
    return 2.0 * std::abs(at.x()) > plane.size_m.x() || 2.0 * std::abs(at.y()) > plane.size_m.y();
}

constexpr double kNearAnchor_m = 0.1;
constexpr double kLongArm_m = 1.0;

bool is_plane(const WorldObject& object) {
    return object.rigid.shape == physics::ObjectShape::kPlane;
}

// In the object's frame; a plane is infinite.
geometry::Aabb local_box_of(const physics::RigidObject& object) {
    geometry::Aabb box;
    if (object.parts) {
        for (const geometry::TriangleMesh& part : *object.parts) {
            for (const Eigen::Vector3d& corner : part.vertices) box.add(corner);
        }
        return box;
    }
    box.max = 0.5 * object.size_m;
    box.min = -box.max;
    if (object.shape != physics::ObjectShape::kPlane) return box;
    const double everywhere_m = std::numeric_limits<double>::infinity();
    box.max = {everywhere_m, everywhere_m, 0.0};
    box.min.setConstant(-everywhere_m);
    return box;
}

// `place_m` is in the object's frame.
double local_distance_m(const Eigen::Vector3d& place_m, const physics::RigidObject& object) {
    const geometry::Aabb box = local_box_of(object);
    return (place_m - place_m.cwiseMax(box.min).cwiseMin(box.max)).norm();
}

// A cheap test: most objects are far apart, and the exact one builds collision shapes.
bool may_overlap(const geometry::Aabb& box, const WorldObject& object) {
    if (is_plane(object)) {
        const geometry::RigidTransform& world_from_plane = object.rigid.world_from_object;
        const Eigen::Vector3d normal = world_from_plane.rotation * Eigen::Vector3d::UnitZ();
        const double reach_m = 0.5 * normal.cwiseAbs().dot(box.size());
        return normal.dot(box.centre() - world_from_plane.translation) < reach_m;
    }
    return touch(box, start_box_of(object.rigid));
}

// Of `moving` inside a surface in the frame of `other` [m].
double depth_in(const geometry::SurfaceTree& surface,
                physics::RigidObject moving,
                const WorldObject& other) {
    moving.world_from_object = other.rigid.world_from_object.inverse() * moving.world_from_object;
    return physics::depth_m(moving, surface);
}

// Each object is compared with the fixed ones and with the moving ones before it.
void doubt_rigid(const WorldDescription& world, std::vector<std::string>& lines) {
    std::vector<DeepStart> deep;
    for (const WorldObject& object : world.objects) {
        if (object.rigid.mass_kg == 0.0) continue;
        const physics::RigidObject moving = to_rigid(object);
        const geometry::Aabb box = start_box_of(moving);
        bool is_before = true;
        for (const WorldObject& other : world.objects) {
            if (&other == &object) is_before = false;
            const bool is_fixed = other.rigid.mass_kg == 0.0;
            if ((!is_fixed && !is_before) || !may_overlap(box, other) ||
                pass_through(world, object.rigid.id, other.rigid.id))
                continue;
            const auto depth_of = [&](const physics::RigidObject& pose) {
                return physics::overlap_m(pose, to_rigid(other));
            };
            const double depth_m = depth_of(moving);
            if (depth_m <= kDeepRigid_m) continue;
            deep.push_back(
                {&object,
                 depth_m,
                 other.name + (is_beside(moving, other.rigid) ? kEndless
                               : is_fixed                     ? ", which is fixed"
                                                              : ", which throws both apart"),
                 cause_in_hollow(other, depth_m, [&](const geometry::SurfaceTree& surface) {
                     return depth_in(surface, moving, other);
                 }) + cure_of(object, depth_of)});
            break;
        }
    }
    add_lines(deep, lines);
}

// A moving object that starts outside is an error.
void doubt_outside(const WorldDescription& world, std::vector<std::string>& lines) {
    const geometry::Aabb bounds = box_of(world.world);
    const auto outside =
        fmt::format("is outside the world's bounds, [{}] to [{}]; places are metres",
                    fmt::join(bounds.min, ", "),
                    fmt::join(bounds.max, ", "));
    for (const WorldObject& object : world.objects) {
        if (object.rigid.mass_kg != 0.0 || is_plane(object)) continue;
        if (touch(start_box_of(to_rigid(object)), bounds)) continue;
        lines.push_back(
            fmt::format("object_looks_wrong name={} reason=\"it {}\"", object.name, outside));
    }
    for (const NamedPlacement& site : world.placements) {
        if (bounds.contains(site.world_from_site.translation)) continue;
        lines.push_back(
            fmt::format("site_looks_wrong name={} reason=\"its place {}\"", site.site, outside));
    }
}

// An object that moves, with an anchor farther away than 1 m and its own size. Below the anchor,
// within 60 degrees, it is a pendulum.
bool is_held_from_afar(const physics::RigidObject& object,
                       const Eigen::Vector3d& anchor_m,
                       const Eigen::Vector3d& gravity) {
    if (object.mass_kg == 0.0) return false;
    const double size_m = local_box_of(object).size().maxCoeff();
    if (distance_m(anchor_m, object) <= std::max(kLongArm_m, size_m)) return false;
    const Eigen::Vector3d arm = start_box_of(object).centre() - anchor_m;
    return arm.dot(gravity) <= 0.5 * arm.norm() * gravity.norm();
}

}  // namespace

double distance_m(const Eigen::Vector3d& place_m, const physics::RigidObject& object) {
    return local_distance_m(object.world_from_object.inverse() * place_m, object);
}

bool pass_through(const WorldDescription& world, std::uint32_t a, std::uint32_t b) {
    return std::ranges::any_of(world.joints, [&](const physics::Joint& joint) {
        return !joint.collides &&
               ((joint.a == a && joint.b == b) || (joint.a == b && joint.b == a));
    });
}

geometry::Aabb moved(const geometry::RigidTransform& to_from, const geometry::Aabb& box) {
    geometry::Aabb around;
    for (int corner = 0; corner < 8; ++corner) {
        around.add(to_from * Eigen::Vector3d((corner & 1) != 0 ? box.max.x() : box.min.x(),
                                             (corner & 2) != 0 ? box.max.y() : box.min.y(),
                                             (corner & 4) != 0 ? box.max.z() : box.min.z()));
    }
    return around;
}

geometry::Aabb start_box_of(const physics::RigidObject& object) {
    return moved(object.world_from_object, local_box_of(object));
}

geometry::Aabb start_box_of(const physics::SoftObject& soft) {
    geometry::Aabb box;
    const physics::SoftMesh mesh = physics::make_soft_mesh(soft);
    for (std::size_t i = 0; i < mesh.nodes.size(); ++i)
        box.add(physics::start_of_node(soft, mesh, i));
    return box;
}

bool touch(const geometry::Aabb& a, const geometry::Aabb& b) {
    return (a.min.array() <= b.max.array()).all() && (b.min.array() <= a.max.array()).all();
}

std::string cure_of(const WorldObject& object, const DepthOfPose& depth_m) {
    if (!object.puppet.empty())
        return "move the puppet with position_m, the place between its feet";
    const std::string& model = object.look.model;
    if (model.empty()) return "move it with position_m, the place of its middle";
    physics::RigidObject turned = to_rigid(object);
    const geometry::RigidTransform& pose = object.rigid.world_from_object;
    const Eigen::Quaterniond upright = geometry::rotation_of_roll_pitch_yaw({90.0, 0.0, 0.0});
    const auto is_free_as = [&](const Eigen::Quaterniond& written,
                                const Eigen::Quaterniond& other) {
        if (pose.rotation.angularDistance(written) > 1e-6) return false;
        turned.world_from_object.rotation = other;
        return depth_m(turned) <= kDeepRigid_m;
    };
    const Eigen::Quaterniond as_in_file = Eigen::Quaterniond::Identity();
    std::string cure;
    if (!model::is_gltf(model) && is_free_as(as_in_file, upright))
        cure = "its file may have +Y up: then write roll_pitch_yaw_deg = [90, 0, 0]; else ";
    else if (model::is_gltf(model) && is_free_as(upright, as_in_file))
        cure = "glTF stands upright as it is: then remove roll_pitch_yaw_deg; else ";
    return cure + "move it with position_m, the place of its file's origin";
}

void add_lines(const std::vector<DeepStart>& starts, std::vector<std::string>& lines) {
    for (const DeepStart& start : starts) {
        const std::string& puppet = start.object->puppet;
        const auto is_deeper_part = [&](const DeepStart& other) {
            return other.object->puppet == puppet &&
                   (other.depth_m > start.depth_m ||
                    (other.depth_m == start.depth_m && &other < &start));
        };
        if (!puppet.empty() && std::ranges::any_of(starts, is_deeper_part)) continue;
        const std::string& name = start.object->name;
        lines.push_back(
            fmt::format("object_looks_wrong name={} reason=\"{}starts {:.2f} m inside {}: {}\"",
                        puppet.empty() ? name : puppet,
                        puppet.empty() ? "" : "its " + name.substr(puppet.size() + 1) + " ",
                        start.depth_m,
                        start.in_what,
                        start.cure));
    }
}

void doubt_starts(const WorldDescription& world, std::vector<std::string>& lines) {
    doubt_rigid(world, lines);
    doubt_outside(world, lines);
}

// Whether a hinge turns about an axis further beside the object than `allowed_m`. A pendulum hangs
// below it.
bool turns_far_beside(const WorldDescription& world,
                      const physics::Joint& joint,
                      const WorldObject& object,
                      double allowed_m) {
    constexpr double kAbove = 0.7;  // sine
    if (joint.kind != physics::JointKind::kHinge || !box_of(world.world).contains(joint.anchor_m) ||
        distance_m(joint.anchor_m, object.rigid) <= allowed_m)
        return false;
    const Eigen::Vector3d middle =
        object.rigid.world_from_object * local_box_of(object.rigid).centre();
    const Eigen::Vector3d off = joint.anchor_m - middle;
    const Eigen::Vector3d beside = off - off.dot(joint.axis) * joint.axis;
    return beside.norm() > allowed_m && beside.z() < kAbove * beside.norm();
}

void doubt_anchors(const WorldDescription& world, std::vector<std::string>& lines) {
    for (const physics::Joint& joint : world.joints) {
        const WorldObject* a = object_of(world, joint.a);
        const WorldObject* b = object_of(world, joint.b);
        if (a == nullptr) continue;
        const auto doubt = [&](const char* key,
                               const Eigen::Vector3d& place_m,
                               double far_m,
                               const std::string& from,
                               const char* advice = "") {
            lines.push_back(fmt::format(
                "joint_looks_wrong a={} b={} reason=\"{} [{}] is {:.2g} m away from {}; it is a "
                "place in the world, not in an object{}\"",
                a->name,
                b == nullptr ? "world" : b->name,
                key,
                fmt::join(place_m, ", "),
                far_m,
                from,
                advice));
        };
        const double from_a_m = distance_m(joint.anchor_m, a->rigid);
        if (b == nullptr) {
            // anything may hang from afar, but hardly from the place that is right in its own
            // frame, or near by from the world's origin
            const double allowed_m = joint.anchor_m.isZero(0.0) ? kNearAnchor_m : kFarAnchor_m;
            const double size_m = local_box_of(a->rigid).size().maxCoeff();
            const bool is_meant_in_a =
                from_a_m > allowed_m &&
                local_distance_m(joint.anchor_m, a->rigid) <= std::max(kNearAnchor_m, 0.5 * size_m);
            if (is_meant_in_a || turns_far_beside(world, joint, *a, std::max(kFarAnchor_m, size_m)))
                doubt("anchor_m", joint.anchor_m, from_a_m, a->name);
            continue;
        }
        if (joint.kind == physics::JointKind::kSpring) {
            const double from_b_m = distance_m(joint.anchor_b_m, b->rigid);
            if (from_a_m > kFarAnchor_m) doubt("anchor_m", joint.anchor_m, from_a_m, a->name);
            if (from_b_m > kFarAnchor_m) doubt("anchor_b_m", joint.anchor_b_m, from_b_m, b->name);
            continue;
        }
        const double from_b_m = distance_m(joint.anchor_m, b->rigid);
        const double nearest_m = std::min(from_a_m, from_b_m);
        if (nearest_m > kFarAnchor_m) {
            doubt("anchor_m", joint.anchor_m, nearest_m, "both objects");
            continue;
        }
        // near neither, but at both if it is meant in the frame of one of them
        const auto meant = [&](const WorldObject& frame) {
            const Eigen::Vector3d place_m = frame.rigid.world_from_object * joint.anchor_m;
            return distance_m(place_m, a->rigid) <= kNearAnchor_m &&
                           distance_m(place_m, b->rigid) <= kNearAnchor_m
                       ? std::optional(place_m)
                       : std::nullopt;
        };
        if (nearest_m > kNearAnchor_m && joint.kind != physics::JointKind::kSlider) {
            const auto in_a = meant(*a);
            const auto place_m = in_a ? in_a : meant(*b);
            if (place_m) {
                doubt("anchor_m",
                      joint.anchor_m,
                      nearest_m,
                      "both objects",
                      fmt::format("; meant in {}, it is [{:.4g}]",
                                  in_a ? a->name : b->name,
                                  fmt::join(*place_m, ", "))
                          .c_str());
                continue;
            }
        }
        const WorldObject* near = from_a_m < from_b_m ? a : b;
        const WorldObject* far = near == a ? b : a;
        // a plane is near everything, and a slider works from any place
        if (joint.kind == physics::JointKind::kSlider || is_plane(*near) ||
            nearest_m > kNearAnchor_m ||
            !is_held_from_afar(far->rigid, joint.anchor_m, world.world.gravity))
            continue;
        doubt("anchor_m",
              joint.anchor_m,
              std::max(from_a_m, from_b_m),
              far->name + ", but at " + near->name,
              "; if it is right, a or b names the wrong one");
    }
}

}  // namespace atrium::world_server
