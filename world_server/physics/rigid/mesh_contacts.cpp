#include "world_server/physics/rigid/mesh_contacts.hpp"

#include "world_server/physics/rigid/ball_triangles.hpp"
#include "world_server/physics/rigid/manifold_points.hpp"
#include "world_server/physics/rigid/mesh_touches.hpp"

#include <BulletCollision/CollisionDispatch/btActivatingCollisionAlgorithm.h>
#include <BulletCollision/CollisionDispatch/btCollisionObjectWrapper.h>
#include <BulletCollision/CollisionDispatch/btConvexConcaveCollisionAlgorithm.h>
#include <BulletCollision/CollisionShapes/btConcaveShape.h>

#include <memory>
#include <vector>

namespace atrium::physics {
namespace {

constexpr btScalar kSameFace = btScalar(0.99);  // cosine of a face's turn in a tick

// What one pair keeps from tick to tick.
struct MeshPair {
    MeshPair(btDispatcher& dispatcher_,
             const btCollisionObjectWrapper* convex,
             const btCollisionObjectWrapper* mesh,
             bool is_mesh_first,
             const FlatContactOptions& options)
        : dispatcher(dispatcher_),
          bullets(&dispatcher_,
                  is_mesh_first ? mesh : convex,
                  is_mesh_first ? convex : mesh,
                  is_mesh_first),
          touches(options),
          ball(options) {}
    ~MeshPair() {
        for (const Flat& flat : flats) dispatcher.releaseManifold(flat.manifold);
    }
    MeshPair(const MeshPair&) = delete;
    MeshPair& operator=(const MeshPair&) = delete;

    struct Flat {
        btPersistentManifold* manifold = nullptr;
        btVector3 normal;
        bool is_used = false;
    };
    // The manifold of a face: that of the tick before, if it touched then.
    btPersistentManifold* manifold_for(const btVector3& normal,
                                       const btCollisionObject* convex,
                                       const btCollisionObject* mesh) {
        for (Flat& flat : flats) {
            if (flat.is_used || flat.normal.dot(normal) < kSameFace) continue;
            flat.normal = normal;
            flat.is_used = true;
            return flat.manifold;
        }
        flats.push_back({dispatcher.getNewManifold(convex, mesh), normal, true});
        return flats.back().manifold;
    }
    void release_unused() {
        std::erase_if(flats, [&](const Flat& flat) {
            if (!flat.is_used) dispatcher.releaseManifold(flat.manifold);
            return !flat.is_used;
        });
    }

    btDispatcher& dispatcher;
    btConvexTriangleCallback bullets;  // with Bullet's own manifold
    MeshTouches touches;
    BallTriangles ball;
    std::vector<MeshTriangle> near;  // then those that are left to Bullet
    std::vector<Flat> flats;
};

struct Collector : btTriangleCallback {
    explicit Collector(std::vector<MeshTriangle>& triangles_) : triangles(triangles_) {}
    void processTriangle(btVector3* corners, int part, int index) override {
        triangles.push_back({{corners[0], corners[1], corners[2]}, part, index});
    }
    std::vector<MeshTriangle>& triangles;
};

class MeshAlgorithm : public btActivatingCollisionAlgorithm {
public:
    MeshAlgorithm(const btCollisionAlgorithmConstructionInfo& info,
                  const btCollisionObjectWrapper* a,
                  const btCollisionObjectWrapper* b,
                  bool is_mesh_first,
                  const FlatContactOptions& options)
        : btActivatingCollisionAlgorithm(info, a, b),
          is_mesh_first_(is_mesh_first),
          pair_(std::make_unique<MeshPair>(*info.m_dispatcher1,
                                           is_mesh_first ? b : a,
                                           is_mesh_first ? a : b,
                                           is_mesh_first,
                                           options)) {}

    void processCollision(const btCollisionObjectWrapper* a,
                          const btCollisionObjectWrapper* b,
                          const btDispatcherInfo& info,
                          btManifoldResult* result) override {
        const btCollisionObjectWrapper& convex = is_mesh_first_ ? *b : *a;
        const btCollisionObjectWrapper& mesh = is_mesh_first_ ? *a : *b;
        find_touches(convex, mesh);
        leave_others_to_bullet(convex, mesh, info, *result);
        for (MeshPair::Flat& flat : pair_->flats) flat.is_used = false;
        for (FlatTouch touch : pair_->touches.touches()) {
            const btTransform& world_from_mesh = mesh.getWorldTransform();
            touch.normal = world_from_mesh.getBasis() * touch.normal;
            for (FlatPoint& point : touch.points) point.on_face = world_from_mesh * point.on_face;
            result->setPersistentManifold(pair_->manifold_for(
                touch.normal, convex.getCollisionObject(), mesh.getCollisionObject()));
            add_touch(*result, touch, /*is_0_end=*/true, /*is_whole=*/true);
        }
        pair_->release_unused();
        result->setPersistentManifold(pair_->bullets.m_manifoldPtr);
    }
    // Asked for by Bullet's continuous dispatch only, which a world does not use.
    btScalar calculateTimeOfImpact(btCollisionObject*,
                                   btCollisionObject*,
                                   const btDispatcherInfo&,
                                   btManifoldResult*) override {
        return 1;
    }
    void getAllContactManifolds(btManifoldArray& manifolds) override {
        manifolds.push_back(pair_->bullets.m_manifoldPtr);
        for (const MeshPair::Flat& flat : pair_->flats) manifolds.push_back(flat.manifold);
    }

private:
    void find_touches(const btCollisionObjectWrapper& convex,
                      const btCollisionObjectWrapper& mesh) {
        const auto& shape = *static_cast<const btConvexShape*>(convex.getCollisionShape());
        const auto& triangles = *static_cast<const btConcaveShape*>(mesh.getCollisionShape());
        const btTransform mesh_from_shape =
            mesh.getWorldTransform().inverse() * convex.getWorldTransform();
        const btScalar reach = pair_->bullets.m_manifoldPtr->getContactBreakingThreshold();
        btVector3 low, high;
        shape.getAabb(mesh_from_shape, low, high);
        const btVector3 around(reach, reach, reach);
        pair_->near.clear();
        Collector collector(pair_->near);
        triangles.processAllTriangles(&collector, low - around, high + around);
        if (shape.getShapeType() == SPHERE_SHAPE_PROXYTYPE) {
            pair_->ball.leave_touched(pair_->near,
                                      mesh_from_shape.getOrigin(),
                                      static_cast<const btSphereShape&>(shape).getRadius(),
                                      reach);
            return;
        }
        pair_->touches.begin(shape, mesh_from_shape, reach);
        for (const MeshTriangle& triangle : pair_->near) pair_->touches.add(triangle);
        pair_->touches.finish();
        pair_->near = pair_->touches.others();
    }
    void leave_others_to_bullet(const btCollisionObjectWrapper& convex,
                                const btCollisionObjectWrapper& mesh,
                                const btDispatcherInfo& info,
                                btManifoldResult& result) {
        btConvexTriangleCallback& bullets = pair_->bullets;
        const auto& triangles = *static_cast<const btConcaveShape*>(mesh.getCollisionShape());
        result.setPersistentManifold(bullets.m_manifoldPtr);
        bullets.setTimeStepAndCounters(triangles.getMargin(), info, &convex, &mesh, &result);
        for (MeshTriangle& triangle : pair_->near)
            bullets.processTriangle(triangle.corners.data(), triangle.part, triangle.index);
        result.refreshContactPoints();
        bullets.clearWrapperData();
    }

    bool is_mesh_first_;
    // Bullet's pool has no room for it
    std::unique_ptr<MeshPair> pair_;
};

// Bullet's pool of algorithms has room for its own largest one.
static_assert(sizeof(MeshAlgorithm) <= sizeof(btConvexConcaveCollisionAlgorithm));

}  // namespace

MeshContacts::Maker::Maker(const FlatContactOptions& flat_options, bool is_mesh_first)
    : options(flat_options), mesh_first(is_mesh_first) {}

btCollisionAlgorithm* MeshContacts::Maker::CreateCollisionAlgorithm(
    btCollisionAlgorithmConstructionInfo& info,
    const btCollisionObjectWrapper* a,
    const btCollisionObjectWrapper* b) {
    void* memory = info.m_dispatcher1->allocateCollisionAlgorithm(sizeof(MeshAlgorithm));
    return new (memory) MeshAlgorithm(info, a, b, mesh_first, options);
}

MeshContacts::MeshContacts(btCollisionDispatcher& dispatcher, const FlatContactOptions& options)
    : options_(options), makers_{Maker(options_, false), Maker(options_, true)} {
    for (const int shape : {CYLINDER_SHAPE_PROXYTYPE,
                            BOX_SHAPE_PROXYTYPE,
                            CONVEX_HULL_SHAPE_PROXYTYPE,
                            SPHERE_SHAPE_PROXYTYPE}) {
        dispatcher.registerCollisionCreateFunc(shape, TRIANGLE_MESH_SHAPE_PROXYTYPE, &makers_[0]);
        dispatcher.registerCollisionCreateFunc(TRIANGLE_MESH_SHAPE_PROXYTYPE, shape, &makers_[1]);
    }
}

}  // namespace atrium::physics
