#include "site_node/rig_check/hull_size.hpp"

#include <fmt/format.h>

namespace atrium::rig_check {
namespace {

constexpr double kHugeVolume_m3 = 50.0;  // some hundred people
constexpr double kHugeExtent_m = 50.0;
constexpr double kTall_m = 3.5;  // taller than a person who stretches, on a chair
constexpr double kTinyVolume_m3 = 1e-4;
constexpr double kTinyExtent_m = 0.1;

}  // namespace

std::optional<std::string> check_size(const geometry::Aabb& extent,
                                      double volume_m3,
                                      double coverage) {
    if (extent.empty()) return std::nullopt;
    const Eigen::Vector3d size = extent.size();
    const std::string is = fmt::format("the hull is {:.3g} x {:.3g} x {:.3g} m large, {:.3g} m3",
                                       size.x(),
                                       size.y(),
                                       size.z(),
                                       volume_m3);
    if (volume_m3 > kHugeVolume_m3 || size.maxCoeff() > kHugeExtent_m) {
        return is + (coverage > 0.8 ? ": the translations of the rig look like another unit than "
                                      "its key units says (\"m\", \"cm\", \"mm\", \"in\", \"ft\")"
                                    : ": rotations or translations of the rig look wrong");
    }
    if (size.z() > kTall_m && coverage > 0.8) {
        return is +
               ": if nobody is that tall, the translations look like feet (units = \"ft\"), or "
               "the focal lengths are too small";
    }
    if (volume_m3 < kTinyVolume_m3 && size.maxCoeff() < kTinyExtent_m && coverage > 0.8) {
        return is +
               ": if that is no hand, the translations of the rig look like another unit than "
               "its key units says";
    }
    return std::nullopt;
}

}  // namespace atrium::rig_check
