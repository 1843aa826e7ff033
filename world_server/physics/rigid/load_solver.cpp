#include "world_server/physics/rigid/load_solver.hpp"

#include <algorithm>

namespace atrium::physics {
namespace {

// Mass of the heavier of two bodies in units of the lighter; 0 if one of them is fixed.
btScalar mass_ratio(const btSolverBody& a, const btSolverBody& b) {
    const btScalar inverse_a = a.internalGetInvMass().x();
    const btScalar inverse_b = b.internalGetInvMass().x();
    if (inverse_a == 0 || inverse_b == 0) return 0;
    return std::max(inverse_a / inverse_b, inverse_b / inverse_a);
}

// Whether the contact carries the heavier body's weight. The normal points to `a`.
bool carries(const btSolverBody& a, const btSolverBody& b, const btVector3& normal) {
    const bool is_a_heavier = a.internalGetInvMass().x() < b.internalGetInvMass().x();
    const btRigidBody& heavier = *(is_a_heavier ? a : b).m_originalBody;
    const btScalar up = -heavier.getGravity().dot(is_a_heavier ? normal : -normal);
    return up > btScalar(0.5) * heavier.getGravity().length();
}

}  // namespace

btScalar LoadSolver::largest_load_on_contacts() const {
    btScalar largest = 0;
    for (int i = 0; i < m_tmpSolverContactConstraintPool.size(); ++i) {
        const btSolverConstraint& row = m_tmpSolverContactConstraintPool[i];
        const btSolverBody& a = m_tmpSolverBodyPool[row.m_solverBodyIdA];
        const btSolverBody& b = m_tmpSolverBodyPool[row.m_solverBodyIdB];
        const btScalar ratio = mass_ratio(a, b);
        if (ratio > largest && carries(a, b, row.m_contactNormal1)) largest = ratio;
    }
    return largest;
}

btScalar LoadSolver::largest_load_on_joints() const {
    btScalar largest = 0;
    for (int i = 0; i < m_tmpSolverNonContactConstraintPool.size(); ++i) {
        const btSolverConstraint& row = m_tmpSolverNonContactConstraintPool[i];
        largest = std::max(largest,
                           mass_ratio(m_tmpSolverBodyPool[row.m_solverBodyIdA],
                                      m_tmpSolverBodyPool[row.m_solverBodyIdB]));
    }
    return largest;
}

btScalar LoadSolver::solveGroupCacheFriendlyIterations(btCollisionObject** bodies,
                                                       int num_bodies,
                                                       btPersistentManifold** manifolds,
                                                       int num_manifolds,
                                                       btTypedConstraint** constraints,
                                                       int num_constraints,
                                                       const btContactSolverInfo& info,
                                                       btIDebugDraw* drawer) {
    const auto iterations_for = [&](btScalar load) {
        return std::min(static_cast<int>(options_.iterations_per_load * load),
                        options_.max_iterations);
    };
    btContactSolverInfo raised = info;
    raised.m_numIterations =
        std::max(info.m_numIterations, iterations_for(largest_load_on_contacts()));
    const int for_joints = iterations_for(largest_load_on_joints());
    if (for_joints > m_maxOverrideNumSolverIterations) {
        m_maxOverrideNumSolverIterations = for_joints;
        for (int i = 0; i < m_tmpSolverNonContactConstraintPool.size(); ++i)
            m_tmpSolverNonContactConstraintPool[i].m_overrideNumSolverIterations = for_joints;
    }
    return btSequentialImpulseConstraintSolver::solveGroupCacheFriendlyIterations(
        bodies, num_bodies, manifolds, num_manifolds, constraints, num_constraints, raised, drawer);
}

}  // namespace atrium::physics
