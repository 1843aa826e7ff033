#include "world_server/physics/start_overlap.hpp"

#include "world_server/physics/rigid/bullet_types.hpp"
#include "world_server/physics/rigid/collision_shape.hpp"
#include "world_server/physics/rigid/shape_distance.hpp"
#include "world_server/physics/soft/soft_mesh.hpp"

#include <BulletCollision/CollisionShapes/btTriangleShape.h>
#include <BulletCollision/NarrowPhaseCollision/btGjkEpa2.h>
#include <btBulletCollisionCommon.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <functional>
#include <vector>

namespace atrium::physics {
namespace {

using EachConvex = std::function<void(const btConvexShape& part, const btTransform& world)>;

void for_each_convex(const btCollisionShape& shape,
                     const btTransform& world_from_shape,
                     const EachConvex& look_at) {
    if (shape.isConvex()) {
        look_at(static_cast<const btConvexShape&>(shape), world_from_shape);
    } else if (shape.isCompound()) {
        const auto& compound = static_cast<const btCompoundShape&>(shape);
        for (int i = 0; i < compound.getNumChildShapes(); ++i) {
            for_each_convex(*compound.getChildShape(i),
                            world_from_shape * compound.getChildTransform(i),
                            look_at);
        }
    }
}

bool may_touch(const btConvexShape& a,
               const btTransform& world_from_a,
               const btConvexShape& b,
               const btTransform& world_from_b) {
    btVector3 low_a, high_a, low_b, high_b;
    a.getAabb(world_from_a, low_a, high_a);
    b.getAabb(world_from_b, low_b, high_b);
    for (int i = 0; i < 3; ++i) {
        if (low_a[i] > high_b[i] || low_b[i] > high_a[i]) return false;
    }
    return true;
}

geometry::Aabb box_of(const btConvexShape& part, const btTransform& world_from_part) {
    btVector3 low, high;
    part.getAabb(world_from_part, low, high);
    geometry::Aabb box;
    box.add(from_bullet(low));
    box.add(from_bullet(high));
    return box;
}

// Cheaper than to build Bullet's shape of a triangle.
bool may_touch(const geometry::Aabb& box, const std::array<Eigen::Vector3d, 3>& corners) {
    const auto& [a, b, c] = corners;
    return (a.cwiseMin(b).cwiseMin(c).array() <= box.max.array()).all() &&
           (a.cwiseMax(b).cwiseMax(c).array() >= box.min.array()).all();
}

double depth_in_plane(const btConvexShape& part,
                      const btTransform& world_from_part,
                      const btStaticPlaneShape& plane,
                      const btTransform& world_from_plane) {
    const btTransform plane_from_part = world_from_plane.inverse() * world_from_part;
    const btVector3 down = -plane.getPlaneNormal();
    const btVector3 lowest =
        plane_from_part * part.localGetSupportingVertex(down * plane_from_part.getBasis());
    return plane.getPlaneConstant() + down.dot(lowest);
}

double depth_in_convex(const btConvexShape& part,
                       const btTransform& world_from_part,
                       const btConvexShape& fixed,
                       const btTransform& world_from_fixed) {
    if (!may_touch(part, world_from_part, fixed, world_from_fixed)) return 0.0;
    btVector3 guess = world_from_fixed.getOrigin() - world_from_part.getOrigin();
    if (guess.fuzzyZero()) guess = btVector3(0, 0, 1);
    btGjkEpaSolver2::sResults results;
    const bool overlaps = btGjkEpaSolver2::Penetration(
        &part, world_from_part, &fixed, world_from_fixed, guess, results);
    return overlaps ? -results.distance : 0.0;
}

using EachNode = std::function<void(const Eigen::Vector3d& node_world)>;

std::vector<bool> held_nodes(const SoftObject& soft, const SoftMesh& mesh) {
    std::vector<bool> is_held(mesh.nodes.size());
    for (const SoftPin& pin : soft.pins) {
        for (const std::uint32_t node : nodes_at(mesh, soft, pin)) is_held[node] = true;
    }
    return is_held;
}

void for_each_free_node(const SoftObject& soft, const EachNode& look_at) {
    const SoftMesh mesh = make_soft_mesh(soft);
    const std::vector<bool> is_held = held_nodes(soft, mesh);
    for (std::size_t i = 0; i < mesh.nodes.size(); ++i)
        if (!is_held[i]) look_at(start_of_node(soft, mesh, i));
}

btTransform world_from_body(const RigidObject& object, const CollisionShape& shape) {
    return to_bullet(object.world_from_object * shape.object_from_body());
}

// How deep a place in the world is inside an object [m]; 0: outside.
class DepthOfNode {
public:
    explicit DepthOfNode(const RigidObject& object)
        : shape_(object), shape_from_world_(world_from_body(object, shape_).inverse()) {}
    double operator()(const Eigen::Vector3d& node_world) {
        const auto found =
            distance_to_shape(shape_.shape(), shape_from_world_ * to_bullet(node_world), 0);
        return found ? std::max<double>(0.0, -found->distance) : 0.0;
    }

private:
    CollisionShape shape_;
    btTransform shape_from_world_;
};

}  // namespace

double overlap_m(const RigidObject& moving, const RigidObject& other) {
    CollisionShape shape(moving);
    CollisionShape other_shape(other);
    const btTransform world_from_other = world_from_body(other, other_shape);
    double deepest_m = 0.0;
    for_each_convex(
        shape.shape(), world_from_body(moving, shape), [&](const auto& part, const auto& pose) {
            if (other.shape == ObjectShape::kPlane) {
                const auto& plane = static_cast<const btStaticPlaneShape&>(other_shape.shape());
                deepest_m =
                    std::max(deepest_m, depth_in_plane(part, pose, plane, world_from_other));
                return;
            }
            for_each_convex(
                other_shape.shape(), world_from_other, [&](const auto& wall, const auto& at) {
                    deepest_m = std::max(deepest_m, depth_in_convex(part, pose, wall, at));
                });
        });
    return deepest_m;
}

double overlap_m(const RigidObject& moving, const geometry::TriangleMesh& scenery) {
    CollisionShape shape(moving);
    double deepest_m = 0.0;
    for_each_convex(
        shape.shape(), world_from_body(moving, shape), [&](const auto& part, const auto& pose) {
            const geometry::Aabb box = box_of(part, pose);
            for (const auto& [a, b, c] : scenery.triangles) {
                const std::array<Eigen::Vector3d, 3> corners{
                    scenery.vertices[a], scenery.vertices[b], scenery.vertices[c]};
                if (!may_touch(box, corners)) continue;
                btTriangleShape triangle(
                    to_bullet(corners[0]), to_bullet(corners[1]), to_bullet(corners[2]));
                triangle.setMargin(0);
                deepest_m = std::max(
                    deepest_m, depth_in_convex(part, pose, triangle, btTransform::getIdentity()));
            }
        });
    return deepest_m;
}

double depth_m(const RigidObject& moving, const geometry::SurfaceTree& bodies) {
    CollisionShape shape(moving);
    double deepest_m = 0.0;
    const auto look_at = [&](const btVector3& place) {
        deepest_m = std::max(deepest_m, bodies.depth_m(from_bullet(place)));
    };
    for_each_convex(
        shape.shape(), world_from_body(moving, shape), [&](const auto& part, const auto& pose) {
            look_at(pose * to_bullet(box_of(part, btTransform::getIdentity()).centre()));
            for (int x = -1; x <= 1; ++x) {
                for (int y = -1; y <= 1; ++y) {
                    for (int z = -1; z <= 1; ++z) {
                        const int num_axes = std::abs(x) + std::abs(y) + std::abs(z);
                        if (num_axes != 1 && num_axes != 3) continue;
                        look_at(pose * part.localGetSupportingVertex(
                                           btVector3(btScalar(x), btScalar(y), btScalar(z))));
                    }
                }
            }
        });
    return deepest_m;
}

double overlap_m(const SoftObject& soft, const RigidObject& fixed) {
    DepthOfNode depth_m(fixed);
    double deepest_m = 0.0;
    for_each_free_node(
        soft, [&](const Eigen::Vector3d& node) { deepest_m = std::max(deepest_m, depth_m(node)); });
    return deepest_m;
}

double pinned_depth_m(const SoftObject& soft, const SoftPin& pin, const RigidObject& rigid) {
    const SoftMesh mesh = make_soft_mesh(soft);
    DepthOfNode depth_m(rigid);
    double deepest_m = 0.0;
    for (const std::uint32_t node : nodes_at(mesh, soft, pin))
        deepest_m = std::max(deepest_m, depth_m(start_of_node(soft, mesh, node)));
    return deepest_m;
}

bool is_skewered(const SoftObject& soft, const RigidObject& rigid) {
    constexpr double kStep_m = 0.005;  // along an edge
    constexpr btScalar kInside_m = -0.002F;
    const bool is_thin = soft.shape == SoftShape::kCloth || soft.shape == SoftShape::kRope;
    if (!is_thin || rigid.shape == ObjectShape::kPlane || !soft.start_nodes.empty()) return false;
    CollisionShape shape(rigid);
    const btTransform shape_from_world = world_from_body(rigid, shape).inverse();
    const auto distance_m = [&](const Eigen::Vector3d& place) {
        const auto found = distance_to_shape(shape.shape(), shape_from_world * to_bullet(place), 0);
        return found ? found->distance : btScalar(1);
    };
    const SoftMesh mesh = make_soft_mesh(soft);
    const std::vector<bool> is_held = held_nodes(soft, mesh);
    for (const SoftLink& link : mesh.links) {
        const auto& [first, second] = link.nodes;
        if (link.bends || is_held[first] || is_held[second]) continue;
        const Eigen::Vector3d a = start_of_node(soft, mesh, first);
        const Eigen::Vector3d b = start_of_node(soft, mesh, second);
        if (distance_m(a) < kInside_m || distance_m(b) < kInside_m) continue;
        const int num_steps = static_cast<int>(std::ceil((b - a).norm() / kStep_m));
        for (int i = 1; i < num_steps; ++i)
            if (distance_m(a + (b - a) * i / num_steps) < kInside_m) return true;
    }
    return false;
}

double depth_m(const SoftObject& soft, const geometry::SurfaceTree& bodies) {
    double deepest_m = 0.0;
    for_each_free_node(soft, [&](const Eigen::Vector3d& node) {
        deepest_m = std::max(deepest_m, bodies.depth_m(node));
    });
    return deepest_m;
}

}  // namespace atrium::physics
