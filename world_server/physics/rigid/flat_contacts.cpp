#include "world_server/physics/rigid/flat_contacts.hpp"

#include "world_server/physics/rigid/flat_face.hpp"
#include "world_server/physics/rigid/manifold_points.hpp"

#include <BulletCollision/CollisionDispatch/btActivatingCollisionAlgorithm.h>
#include <BulletCollision/CollisionDispatch/btCollisionObjectWrapper.h>
#include <BulletCollision/CollisionDispatch/btConvexConvexAlgorithm.h>

#include <optional>

namespace atrium::physics {
namespace {

class FlatAlgorithm : public btActivatingCollisionAlgorithm {
public:
    FlatAlgorithm(const btCollisionAlgorithmConstructionInfo& info,
                  const btCollisionObjectWrapper* a,
                  const btCollisionObjectWrapper* b,
                  btCollisionAlgorithmCreateFunc& bullets,
                  const FlatContactOptions& options)
        : btActivatingCollisionAlgorithm(info, a, b),
          options_(options),
          manifold_(info.m_manifold),
          owns_manifold_(info.m_manifold == nullptr),
          is_shared_(!owns_manifold_) {
        if (owns_manifold_) {
            manifold_ =
                m_dispatcher->getNewManifold(a->getCollisionObject(), b->getCollisionObject());
        }
        btCollisionAlgorithmConstructionInfo shared = info;
        shared.m_manifold = manifold_;
        bullets_ = bullets.CreateCollisionAlgorithm(shared, a, b);
        take_manifold_of_bullets();
    }
    FlatAlgorithm(const FlatAlgorithm&) = delete;
    FlatAlgorithm& operator=(const FlatAlgorithm&) = delete;
    ~FlatAlgorithm() override {
        bullets_->~btCollisionAlgorithm();
        m_dispatcher->freeCollisionAlgorithm(bullets_);
        if (owns_manifold_) m_dispatcher->releaseManifold(manifold_);
    }

    void processCollision(const btCollisionObjectWrapper* a,
                          const btCollisionObjectWrapper* b,
                          const btDispatcherInfo& info,
                          btManifoldResult* result) override {
        result->setPersistentManifold(manifold_);
        if (!add_flat(*a, *b, *result)) bullets_->processCollision(a, b, info, result);
        if (!is_shared_) result->refreshContactPoints();
    }
    btScalar calculateTimeOfImpact(btCollisionObject* a,
                                   btCollisionObject* b,
                                   const btDispatcherInfo& info,
                                   btManifoldResult* result) override {
        return bullets_->calculateTimeOfImpact(a, b, info, result);
    }
    void getAllContactManifolds(btManifoldArray& manifolds) override {
        if (owns_manifold_) manifolds.push_back(manifold_);
        bullets_->getAllContactManifolds(manifolds);
    }

private:
    // That of planes always brings its own.
    void take_manifold_of_bullets() {
        btManifoldArray own;
        bullets_->getAllContactManifolds(own);
        if (own.size() == 0) return;
        if (owns_manifold_) m_dispatcher->releaseManifold(manifold_);
        owns_manifold_ = false;
        manifold_ = own[0];
        is_shared_ = false;
    }

    bool add_flat(const btCollisionObjectWrapper& a,
                  const btCollisionObjectWrapper& b,
                  btManifoldResult& result) {
        // the end of a cylinder lies on the other's face
        const bool is_a_end = a.getCollisionShape()->getShapeType() == CYLINDER_SHAPE_PROXYTYPE;
        const btCollisionObjectWrapper& upper = is_a_end ? a : b;
        const btCollisionObjectWrapper& lower = is_a_end ? b : a;
        const std::optional<FlatTouch> touch =
            find_flat_touch(*static_cast<const btCylinderShapeZ*>(upper.getCollisionShape()),
                            upper.getWorldTransform(),
                            *lower.getCollisionShape(),
                            lower.getWorldTransform(),
                            manifold_->getContactBreakingThreshold(),
                            options_);
        if (!touch) return false;
        const bool is_0_end = manifold_->getBody0() == upper.getCollisionObject();
        add_touch(result, *touch, is_0_end, /*is_whole=*/!is_shared_);
        return true;
    }

    const FlatContactOptions& options_;
    btPersistentManifold* manifold_;
    bool owns_manifold_;
    bool is_shared_;  // with other parts
    btCollisionAlgorithm* bullets_ = nullptr;
};

// Bullet's pool of algorithms has room for its own largest one.
static_assert(sizeof(FlatAlgorithm) <= sizeof(btConvexConvexAlgorithm));

}  // namespace

FlatContacts::Maker::Maker(btCollisionAlgorithmCreateFunc& others,
                           const FlatContactOptions& flat_options)
    : bullets(others), options(flat_options) {}

btCollisionAlgorithm* FlatContacts::Maker::CreateCollisionAlgorithm(
    btCollisionAlgorithmConstructionInfo& info,
    const btCollisionObjectWrapper* a,
    const btCollisionObjectWrapper* b) {
    void* memory = info.m_dispatcher1->allocateCollisionAlgorithm(sizeof(FlatAlgorithm));
    return new (memory) FlatAlgorithm(info, a, b, bullets, options);
}

FlatContacts::FlatContacts(btCollisionDispatcher& dispatcher,
                           btCollisionConfiguration& configuration,
                           const FlatContactOptions& options)
    : options_(options) {
    const auto take_over = [&](int a, int b) {
        makers_.emplace_back(*configuration.getCollisionAlgorithmCreateFunc(a, b), options_);
        dispatcher.registerCollisionCreateFunc(a, b, &makers_.back());
    };
    take_over(CYLINDER_SHAPE_PROXYTYPE, CYLINDER_SHAPE_PROXYTYPE);
    for (const int other :
         {BOX_SHAPE_PROXYTYPE, CONVEX_HULL_SHAPE_PROXYTYPE, STATIC_PLANE_PROXYTYPE}) {
        take_over(CYLINDER_SHAPE_PROXYTYPE, other);
        take_over(other, CYLINDER_SHAPE_PROXYTYPE);
    }
}

}  // namespace atrium::physics
