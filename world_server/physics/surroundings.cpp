#include "world_server/physics/surroundings.hpp"

#include "world_server/physics/rigid/bullet_types.hpp"

#include <btBulletDynamicsCommon.h>

#include <cstdint>

namespace atrium::physics {

// Members are destroyed in reverse order, as Bullet requires.
struct Surroundings::Piece {
    std::vector<float> vertices;  // x, y, z of each; the shape reads them for its lifetime
    std::vector<int> triangles;
    std::unique_ptr<btTriangleIndexVertexArray> mesh;
    std::unique_ptr<btCollisionShape> shape;
    std::unique_ptr<btRigidBody> body;
};

Surroundings::Surroundings(btDynamicsWorld& world, int group, int mask)
    : world_(world), group_(group), mask_(mask) {}

Surroundings::~Surroundings() {
    for (const auto& piece : pieces_) world_.removeRigidBody(piece->body.get());
}

bool Surroundings::add(const StaticMesh& still) {
    const geometry::TriangleMesh& mesh = still.mesh;
    if (mesh.triangles.empty() || mesh.triangles.size() > kMaxStaticTriangles) return false;
    auto piece = std::make_unique<Piece>();
    for (const Eigen::Vector3d& v : mesh.vertices) {
        if (!v.allFinite()) return false;
        for (const double x : v) piece->vertices.push_back(static_cast<float>(x));
    }
    for (const auto& triangle : mesh.triangles) {
        for (const std::uint32_t index : triangle) {
            if (index >= mesh.vertices.size()) return false;
            piece->triangles.push_back(static_cast<int>(index));
        }
    }
    piece->mesh =
        std::make_unique<btTriangleIndexVertexArray>(static_cast<int>(mesh.triangles.size()),
                                                     piece->triangles.data(),
                                                     static_cast<int>(3 * sizeof(int)),
                                                     static_cast<int>(mesh.vertices.size()),
                                                     piece->vertices.data(),
                                                     static_cast<int>(3 * sizeof(float)));
    auto shape = std::make_unique<btBvhTriangleMeshShape>(piece->mesh.get(),
                                                          /*useQuantizedAabbCompression=*/true);
    piece->shape = std::move(shape);
    place(std::move(piece), still.friction, still.restitution);
    return true;
}

void Surroundings::add_walls(const geometry::Aabb& box, double friction, double restitution) {
    for (int axis = 0; axis < 3; ++axis) {
        for (const double sign : {1.0, -1.0}) {
            const Eigen::Vector3d normal = sign * Eigen::Vector3d::Unit(axis);
            const double offset = sign > 0.0 ? box.min[axis] : -box.max[axis];
            auto piece = std::make_unique<Piece>();
            piece->shape =
                std::make_unique<btStaticPlaneShape>(to_bullet(normal), btScalar(offset));
            place(std::move(piece), friction, restitution);
        }
    }
}

void Surroundings::place(std::unique_ptr<Piece> piece, double friction, double restitution) {
    btRigidBody::btRigidBodyConstructionInfo info(btScalar(0), nullptr, piece->shape.get());
    info.m_friction = btScalar(friction);
    info.m_restitution = btScalar(restitution);
    piece->body = std::make_unique<btRigidBody>(info);
    world_.addRigidBody(piece->body.get(), group_, mask_);
    bodies_.push_back(piece->body.get());
    pieces_.push_back(std::move(piece));
}

}  // namespace atrium::physics
