#include "world_server/physics/options/world_options.hpp"

namespace atrium::physics {

geometry::Aabb box_of(const WorldOptions& options) {
    if (options.box) return *options.box;
    const double far = options.half_extent_m;
    return {.min = {-far, -far, options.lowest_z_m}, .max = Eigen::Vector3d::Constant(far)};
}

}  // namespace atrium::physics
