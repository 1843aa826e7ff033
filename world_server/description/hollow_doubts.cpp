#include "world_server/description/hollow_doubts.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <set>

namespace atrium::world_server {
namespace {

// Shares of the hulls' volume that the surface encloses: of a bucket or a bowl about a tenth.
constexpr double kHollowShare = 0.5;
constexpr double kSolidShare = 0.8;

double enclosed_share(const WorldObject& object) {
    double hulls_m3 = 0.0;
    for (const geometry::TriangleMesh& hull : *object.rigid.parts)
        hulls_m3 += geometry::volume_m3(hull);
    return geometry::volume_m3(*object.surface) / hulls_m3;
}

std::string fills(const WorldObject& object) {
    return fmt::format(
        "the physics fills the hollow of {}: split it into {} (`o` lines of an OBJ, "
        "meshes of a GLB) with shape = 'compound'",
        object.name,
        object.rigid.parts->size() > 1 ? "more parts" : "parts");
}

}  // namespace

std::string cause_in_hollow(const WorldObject& object,
                            double overlap_m,
                            const DepthInSurface& depth_m) {
    if (!object.surface || enclosed_share(object) > kSolidShare) return {};
    if (depth_m(geometry::SurfaceTree(*object.surface)) > 0.5 * overlap_m) return {};
    return fills(object) + ", or ";
}

void doubt_hollows(const WorldDescription& world, std::vector<std::string>& lines) {
    std::set<std::string> known;  // models
    for (const WorldObject& object : world.objects) {
        if (object.rigid.shape != physics::ObjectShape::kCompound || !object.surface ||
            object.rigid.parts->size() > 1 || !known.insert(object.look.model).second)
            continue;
        const double share = enclosed_share(object);
        const auto is_said = [&](const std::string& line) {
            return line.find("fills the hollow of " + object.name + ":") != std::string::npos;
        };
        if (share >= kHollowShare || std::ranges::any_of(lines, is_said)) continue;
        lines.push_back(
            fmt::format("object_looks_wrong name={} model={} reason=\"its file has one part, whose "
                        "surface encloses {:.0f} % of its convex hull: {}\"",
                        object.name,
                        object.look.model,
                        100.0 * share,
                        fills(object)));
    }
}

}  // namespace atrium::world_server
