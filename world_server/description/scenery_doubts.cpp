#include "world_server/description/scenery_doubts.hpp"

#include "core/model/model_file.hpp"
#include "world_server/description/start_doubts.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace atrium::world_server {
namespace {

constexpr double kDrawn_m = 100.0;   // viewers draw nothing further away (renderer::ViewCamera)
constexpr double kUseless_m = 10.0;  // solid scenery this far outside is touched by nothing
constexpr double kSmallest_m = 0.05;
constexpr double kInside_m = 0.001;
constexpr double kOfSide = 0.05;  // shares of the scenery's size
constexpr double kOfDepth = 0.25;
const Eigen::Quaterniond kAsInFile = Eigen::Quaterniond::Identity();

// False if nothing is wrong.
bool doubt_size(const WorldDescription& world,
                const WorldScenery& scenery,
                std::vector<std::string>& lines) {
    const double world_m = 2.0 * box_of(world.world).size().maxCoeff();
    const double largest_m = scenery.is_solid ? world_m : std::max(world_m, kDrawn_m);
    const Eigen::Vector3d size_m = scenery.box.size();
    const bool is_large = size_m.maxCoeff() > largest_m;
    if (!is_large && size_m.maxCoeff() >= kSmallest_m) return false;
    lines.push_back(
        fmt::format("scenery_looks_wrong name={} reason=\"it is {:.3g} x {:.3g} x {:.3g} m "
                    "large{}\"",
                    scenery.name,
                    size_m.x(),
                    size_m.y(),
                    size_m.z(),
                    is_large ? ", more than twice the world; scale = 0.01 reads centimetres, 0.001 "
                               "millimetres"
                             : ": check its scale; 1 reads metres"));
    return true;
}

// False if nothing is wrong.
bool doubt_place(const WorldDescription& world,
                 const WorldScenery& scenery,
                 std::vector<std::string>& lines) {
    const geometry::Aabb bounds = box_of(world.world);
    const Eigen::Vector3d gap_m =
        (bounds.min - scenery.box.max).cwiseMax(scenery.box.min - bounds.max).cwiseMax(0.0);
    if (gap_m.norm() <= (scenery.is_solid ? kUseless_m : kDrawn_m)) return false;
    lines.push_back(
        fmt::format("scenery_looks_wrong name={} reason=\"all of it is {:.3g} m or more outside "
                    "the world's bounds, [{}] to [{}]; places are metres\"",
                    scenery.name,
                    gap_m.norm(),
                    fmt::join(bounds.min, ", "),
                    fmt::join(bounds.max, ", ")));
    return true;
}

// What the object hides, in its frame: a plane what is below its drawn part, a box what is in it.
geometry::Aabb hidden_by(const physics::RigidObject& object) {
    geometry::Aabb hidden;
    if (object.mass_kg != 0.0) return hidden;
    hidden.max = 0.5 * object.size_m;
    hidden.min = -hidden.max;
    if (object.shape == physics::ObjectShape::kPlane) {
        hidden.max.z() = 0.0;
        hidden.min.z() = -std::numeric_limits<double>::infinity();
    } else if (object.shape != physics::ObjectShape::kBox) {
        return {};
    }
    hidden.max.array() -= kInside_m;  // what stands on a floor may touch it
    hidden.min.array() += kInside_m;
    return hidden;
}

void doubt_sight(const WorldDescription& world,
                 const WorldScenery& scenery,
                 std::vector<std::string>& lines) {
    const auto hides = [&](const WorldObject& object) {
        const geometry::Aabb hidden = hidden_by(object.rigid);
        const geometry::Aabb box =
            moved(object.rigid.world_from_object.inverse(), scenery.box);  // in its frame
        return hidden.contains(box.min) && hidden.contains(box.max);
    };
    const auto object = std::ranges::find_if(world.objects, hides);
    if (object == world.objects.end()) return;
    lines.push_back(
        fmt::format("scenery_looks_wrong name={} reason=\"all of it is {} {}, where nobody sees "
                    "it: {}move it with position_m, the place of its file's origin\"",
                    scenery.name,
                    object->rigid.shape == physics::ObjectShape::kPlane ? "below" : "inside",
                    object->name,
                    model::is_gltf(scenery.look.model)
                        ? ""
                        : "if its file has +Y up, write roll_pitch_yaw_deg = [90, 0, 0]; else "));
}

// A file with +Y up lies on its side: it begins at y = 0, and its depth is half below the floor.
void doubt_upright(const WorldDescription& world,
                   const WorldScenery& scenery,
                   std::vector<std::string>& lines) {
    const geometry::RigidTransform& pose = scenery.world_from_model;
    if (model::is_gltf(scenery.look.model) || !pose.rotation.isApprox(kAsInFile)) return;
    const Eigen::Vector3d size = scenery.box.size();
    const Eigen::Vector3d lowest = scenery.box.min - pose.translation;
    const Eigen::Vector3d highest = scenery.box.max - pose.translation;
    const bool begins_at_zero = std::abs(lowest.y()) < kOfSide * size.y() && size.y() > size.z();
    const bool is_even = std::abs(lowest.z() + highest.z()) < kOfDepth * size.z();
    const auto is_half_below = [&](const WorldObject& object) {
        if (object.rigid.shape != physics::ObjectShape::kPlane || object.rigid.mass_kg != 0.0)
            return false;
        const geometry::Aabb box = moved(object.rigid.world_from_object.inverse(), scenery.box);
        return box.min.z() < -kOfDepth * size.z() && box.max.z() > kOfDepth * size.z();
    };
    const auto floor = std::ranges::find_if(world.objects, is_half_below);
    if (!begins_at_zero || !is_even || floor == world.objects.end()) return;
    lines.push_back(
        fmt::format("scenery_looks_wrong name={} reason=\"half of it is below {}, as if it lay on "
                    "its side: if its file has +Y up, write roll_pitch_yaw_deg = [90, 0, 0]\"",
                    scenery.name,
                    floor->name));
}

}  // namespace

void doubt_scenery(const WorldDescription& world, std::vector<std::string>& lines) {
    for (const WorldScenery& scenery : world.scenery) {
        if (doubt_size(world, scenery, lines) || doubt_place(world, scenery, lines)) continue;
        doubt_sight(world, scenery, lines);
        doubt_upright(world, scenery, lines);
    }
}

}  // namespace atrium::world_server
