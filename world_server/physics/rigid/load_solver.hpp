#pragma once

#include "world_server/physics/options/rigid_options.hpp"

#include <btBulletDynamicsCommon.h>

namespace atrium::physics {

/// Solves with more iterations while something light carries something heavy: a box of 70 kg on
/// one of 1 kg sinks and slides with the usual number. The error of an iterative solver decays more
/// slowly the larger the ratio of the masses. All else is solved like before.
class LoadSolver : public btSequentialImpulseConstraintSolver {
public:
    explicit LoadSolver(const LoadOptions& options) : options_(options) {}

protected:
    btScalar solveGroupCacheFriendlyIterations(btCollisionObject** bodies,
                                               int num_bodies,
                                               btPersistentManifold** manifolds,
                                               int num_manifolds,
                                               btTypedConstraint** constraints,
                                               int num_constraints,
                                               const btContactSolverInfo& info,
                                               btIDebugDraw* drawer) override;

private:
    btScalar largest_load_on_contacts() const;
    btScalar largest_load_on_joints() const;

    LoadOptions options_;
};

}  // namespace atrium::physics
