#include "world_server/physics/world.hpp"

namespace atrium::physics {

geometry::Aabb box_of(const WorldOptions& options) {
    if (options.box) return *options.box;
    const double far = options.half_extent_m;
    return {.min = {-far, -far, options.lowest_z_m}, .max = Eigen::Vector3d::Constant(far)};
}

std::string_view describe(IncidentKind kind) {
    switch (kind) {
        case IncidentKind::kNotFinite:
            return "had a state that was not finite and was reset";
        case IncidentKind::kRunaway:
            return "became far too fast and was reset";
        case IncidentKind::kTorn:
            return "was torn and was reset";
        case IncidentKind::kRemoved:
            return "left the world and was removed";
        case IncidentKind::kLeft:
            break;
    }
    return "left the world and was reset";
}

}  // namespace atrium::physics
