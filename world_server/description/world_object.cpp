#include "world_server/description/world_object.hpp"

namespace atrium::world_server {

physics::RigidObject to_rigid(const WorldObject& object) {
    physics::RigidObject rigid = object.rigid;
    if (rigid.parts && rigid.parts->size() == 1) rigid.shape = physics::ObjectShape::kConvex;
    return rigid;
}

}  // namespace atrium::world_server
