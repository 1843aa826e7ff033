#include "world_server/physics/person_body.hpp"

#include <BulletCollision/CollisionShapes/btConvexPointCloudShape.h>
#include <btBulletDynamicsCommon.h>

#include <algorithm>
#include <array>
#include <cassert>

namespace atrium::physics {
namespace {

// Skin around a piece: closes the seams that are left between pieces of which only the extreme
// points in a few directions are kept.
constexpr btScalar kMarginM = 0.004F;

btVector3 to_bullet(const Eigen::Vector3f& v) { return {v.x(), v.y(), v.z()}; }

}  // namespace

struct PersonBody::Piece {
    BT_DECLARE_ALIGNED_ALLOCATOR();
    Piece(const PersonMaterial& material, PersonBody* person);

    std::array<btVector3, kMaxPointsPerPiece> points;
    btConvexPointCloudShape shape;
    btVector3 centre{0, 0, 0};  // where the mesh was captured
    btVector3 velocity{0, 0, 0};
    std::unique_ptr<btRigidBody> body;
};

PersonBody::Piece::Piece(const PersonMaterial& material, PersonBody* person) {
    points.fill(btVector3(0, 0, 0));
    shape.setPoints(points.data(), 1);
    shape.setMargin(kMarginM);
    body = std::make_unique<btRigidBody>(0.0F, nullptr, &shape);
    body->setCollisionFlags(body->getCollisionFlags() | btCollisionObject::CF_KINEMATIC_OBJECT);
    body->setUserPointer(person);
    // an active kinematic body wakes every sleeping object that it touches
    body->setActivationState(DISABLE_DEACTIVATION);
    body->setFriction(static_cast<btScalar>(material.friction));
    body->setRestitution(static_cast<btScalar>(material.restitution));
}

PersonBody::PersonBody(btDiscreteDynamicsWorld& world, const PersonMaterial& material)
    : world_(world), material_(material) {}

PersonBody::~PersonBody() {
    for (std::size_t i = 0; i < num_used_; ++i) world_.removeRigidBody(pool_[i]->body.get());
}

void PersonBody::place(Piece& piece, double time_to_go_s) const {
    btTransform transform = btTransform::getIdentity();
    transform.setOrigin(piece.centre - piece.velocity * static_cast<btScalar>(time_to_go_s));
    piece.body->setWorldTransform(transform);
    piece.body->setInterpolationWorldTransform(transform);
}

void PersonBody::set_shape(const PersonShape& shape) {
    assert(shape.velocities.size() == shape.solid.pieces.size());
    surface_ = shape.surface;
    time_to_go_s_ = shape.period_s;
    const std::size_t num_pieces = shape.solid.pieces.size();
    while (pool_.size() < num_pieces) pool_.push_back(std::make_unique<Piece>(material_, this));
    btOverlappingPairCache& pairs = *world_.getBroadphase()->getOverlappingPairCache();
    for (std::size_t i = 0; i < num_pieces; ++i) {
        const ConvexPiece& source = shape.solid.pieces[i];
        Piece& piece = *pool_[i];
        assert(source.num_points >= 1 && source.num_points <= kMaxPointsPerPiece);
        for (std::size_t p = 0; p < source.num_points; ++p) {
            piece.points[p] = to_bullet(shape.solid.points[source.first_point + p]);
        }
        piece.shape.setPoints(piece.points.data(), static_cast<int>(source.num_points));
        piece.centre = to_bullet(source.centre);
        piece.velocity = to_bullet(shape.velocities[i]);
        place(piece, time_to_go_s_);
        if (i >= num_used_) {
            world_.addRigidBody(piece.body.get(), kPersonGroup, kObjectGroup);
        } else {
            // contacts found with the former shape mean nothing now
            pairs.cleanProxyFromPairs(piece.body->getBroadphaseHandle(), world_.getDispatcher());
        }
    }
    for (std::size_t i = num_pieces; i < num_used_; ++i) {
        world_.removeRigidBody(pool_[i]->body.get());
    }
    num_used_ = num_pieces;
}

void PersonBody::begin_tick(double tick_s) {
    const double moving_s = std::min(tick_s, time_to_go_s_);
    for (std::size_t i = 0; i < num_used_; ++i) {
        Piece& piece = *pool_[i];
        place(piece, time_to_go_s_);
        const btVector3 velocity = piece.velocity * static_cast<btScalar>(moving_s / tick_s);
        piece.body->setLinearVelocity(velocity);
        piece.body->setInterpolationLinearVelocity(velocity);
        piece.body->setAngularVelocity(btVector3(0, 0, 0));
    }
    time_to_go_s_ -= moving_s;
}

}  // namespace atrium::physics
