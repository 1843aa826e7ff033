#include "world_server/physics/soft/soft_depenetration.hpp"

#include "world_server/physics/people/people_field.hpp"
#include "world_server/physics/rigid/bullet_types.hpp"
#include "world_server/physics/soft/soft_sample.hpp"

#include <BulletSoftBody/btSoftBody.h>

#include <cmath>

namespace atrium::physics {

// A surface near the centre of a volume drives the whole volume. If the centre is inside a person,
// the person surrounds the volume and no contact leads out. The volume then moves to the nearest
// surface, without contacts.
bool SoftDepenetration::find(const btSoftBody& soft,
                             btScalar inner_radius_m,
                             btScalar escape_mps,
                             const SoftDepenetrationOptions& options,
                             const PeopleField& people) {
    pushes_.clear();
    const Eigen::Vector3f at = centre_of(soft).cast<float>();
    btVector3 sum(0, 0, 0);
    for (int i = 0; i < soft.m_nodes.size(); ++i) sum += soft.m_nodes[i].m_v;
    sum /= btScalar(soft.m_nodes.size());
    const Eigen::Vector3f velocity(sum.x(), sum.y(), sum.z());
    const float leaving_mps = options.leaving_mps;
    const float reach = options.keep_off_radii * inner_radius_m;
    const Eigen::Vector3f around = Eigen::Vector3f::Constant(reach);
    for (const auto& [name, person] : people.people()) {
        const PlacedSurfel* nearest = nullptr;
        float nearest_sq = reach * reach;
        person.surfels().visit_box(at - around, at + around, [&](const PlacedSurfel& s) {
            const float distance_sq = (at - s.position).squaredNorm();
            if (distance_sq >= nearest_sq) return;
            if (s.normal.dot(velocity - s.velocity) > leaving_mps) return;
            nearest_sq = distance_sq;
            nearest = &s;
        });
        if (nearest != nullptr && nearest->normal.dot(at - nearest->position) >= 0.0F) {
            const btVector3 out(nearest->normal.x(), nearest->normal.y(), nearest->normal.z());
            const btScalar near = 1 - std::sqrt(nearest_sq) / reach;
            pushes_.push_back(
                {out, nearest->normal.dot(nearest->velocity) + options.keep_off_mps * near});
            continue;
        }
        const PlacedSurfel* side =
            person.nearest(at, options.buried_search_m, [](const PlacedSurfel& s) {
                return s.normal.z() > -0.5F;
            });
        if (side == nullptr || side->normal.dot(at - side->position) > 0.0F) continue;
        pushes_.push_back({to_bullet(side->normal), escape_mps});
        return false;
    }
    return true;
}

void SoftDepenetration::apply(btSoftBody& soft) const {
    for (const Push& push : pushes_) {
        for (int i = 0; i < soft.m_nodes.size(); ++i) {
            btSoftBody::Node& node = soft.m_nodes[i];
            const btScalar missing = push.speed - node.m_v.dot(push.out);
            if (node.m_im > 0 && missing > 0) node.m_v += push.out * missing;
        }
    }
}

}  // namespace atrium::physics
