#include "world_server/physics/rigid/flat_contacts.hpp"

#include "world_server/physics/rigid/flat_face.hpp"

#include <BulletCollision/CollisionDispatch/btActivatingCollisionAlgorithm.h>
#include <BulletCollision/CollisionDispatch/btCollisionObjectWrapper.h>
#include <BulletCollision/CollisionDispatch/btConvexConvexAlgorithm.h>

#include <algorithm>
#include <array>
#include <optional>
#include <span>

namespace atrium::physics {
namespace {

// Removes the old points that no new one replaces. The others keep their impulses.
void remove_others(btPersistentManifold& manifold,
                   const btTransform& body0_from_world,
                   std::span<const btVector3> on_0) {
    const btScalar near = manifold.getContactBreakingThreshold();
    for (int i = manifold.getNumContacts() - 1; i >= 0; --i) {
        const btVector3& old = manifold.getContactPoint(i).m_localPointA;
        const bool is_kept = std::any_of(on_0.begin(), on_0.end(), [&](const auto& p) {
            return (body0_from_world * p - old).length2() < near * near;
        });
        if (!is_kept) manifold.removeContactPoint(i);
    }
}

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
        // normals point to the manifold's first body; places are on its second
        const bool is_0_end = manifold_->getBody0() == upper.getCollisionObject();
        const btVector3 to_0 = is_0_end ? touch->normal : -touch->normal;
        std::array<btVector3, 4> on_0;
        std::array<btVector3, 4> on_1;
        for (std::size_t i = 0; i < touch->points.size(); ++i) {
            const FlatPoint& p = touch->points[i];
            const btVector3 on_end = p.on_face + p.gap * touch->normal;
            on_0[i] = is_0_end ? on_end : p.on_face;
            on_1[i] = is_0_end ? p.on_face : on_end;
        }
        if (!is_shared_)
            remove_others(*manifold_, manifold_->getBody0()->getWorldTransform().inverse(), on_0);
        for (std::size_t i = 0; i < on_1.size(); ++i)
            result.addContactPoint(to_0, on_1[i], touch->points[i].gap);
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
