#include "world_server/description/soft_doubts.hpp"

#include "world_server/description/hollow_doubts.hpp"
#include "world_server/description/start_doubts.hpp"
#include "world_server/physics/soft/soft_mesh.hpp"
#include "world_server/physics/start_overlap.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <limits>
#include <string>

namespace atrium::world_server {
namespace {

constexpr double kFarTie_m = 0.1;  // a rope visibly ends in the air

bool may_be_in(const geometry::Aabb& soft, const physics::RigidObject& rigid) {
    if (rigid.shape == physics::ObjectShape::kPlane) return true;
    return touch(soft, start_box_of(rigid));
}

// A movable object falls over if a place that cannot give way starts so deep inside it. At its
// surface it stands.
constexpr double kDeepPin_m = 0.0075;

bool is_tied(const WorldSoftObject& soft, const WorldObject& object) {
    return std::ranges::any_of(soft.object.pins, [&](const physics::SoftPin& pin) {
        return pin.object_id == object.rigid.id;
    });
}

std::string quoted(const std::vector<std::string>& names) {
    return fmt::format("['{}']", fmt::join(names, "', '"));
}

// What to write so that the places in `holders` (0: none) are tied; empty: it cannot be written.
std::string ties_of(const WorldDescription& world,
                    const WorldSoftObject& soft,
                    const std::vector<std::uint32_t>& holders) {
    std::vector<std::string> pins, tied, tied_to;
    for (std::size_t i = 0; i < holders.size(); ++i) {
        const WorldObject* holder = object_of(world, holders[i]);
        (holder == nullptr ? pins : tied)
            .push_back(pin_name(soft.object.pins[i].place, soft.object.shape));
        if (holder != nullptr) tied_to.push_back(holder->name);
    }
    const bool is_one = std::ranges::count(tied_to, tied_to.front()) == std::ssize(tied_to);
    if (!is_one && soft.object.shape != physics::SoftShape::kRope) return {};
    return fmt::format("tied = {} and tied_to = {}{}",
                       quoted(tied),
                       is_one ? "'" + tied_to.front() + "'" : quoted(tied_to),
                       pins.empty() ? "" : " beside pins = " + quoted(pins));
}

// Places that are fixed in the world but start inside objects that move. False: there are none.
bool doubt_pins(const WorldDescription& world,
                const WorldSoftObject& soft,
                std::vector<std::string>& lines) {
    std::vector<std::string> places;
    std::vector<std::uint32_t> holders;  // of each pin
    for (const physics::SoftPin& pin : soft.object.pins) {
        holders.push_back(pin.object_id);
        if (pin.object_id != 0) continue;
        double deepest_m = kDeepPin_m;
        const WorldObject* deepest = nullptr;
        for (const WorldObject& object : world.objects) {
            if (object.rigid.mass_kg == 0.0 || is_tied(soft, object)) continue;
            const physics::RigidObject rigid = to_rigid(object);
            if (!touch(start_box_of(soft.object), start_box_of(rigid))) continue;
            const double depth_m = physics::pinned_depth_m(soft.object, pin, rigid);
            if (depth_m <= deepest_m) continue;
            deepest_m = depth_m;
            deepest = &object;
        }
        if (deepest == nullptr) continue;
        holders.back() = deepest->rigid.id;
        places.push_back(fmt::format("{} {:.2f} m inside {}",
                                     pin_name(pin.place, soft.object.shape),
                                     deepest_m,
                                     deepest->name));
    }
    if (places.empty()) return false;
    const std::string ties = ties_of(world, soft, holders);
    const bool is_rope = soft.object.shape == physics::SoftShape::kRope;
    lines.push_back(
        fmt::format("soft_looks_wrong name={} reason=\"its pins start inside what can move and "
                    "throw it over: {}; {}{}\"",
                    soft.name,
                    fmt::join(places, ", "),
                    ties.empty() ? "" : "instead write " + ties + ", or ",
                    is_rope ? "shorten span_m or move it" : "move one of them with position_m"));
    return true;
}

// `mesh` is that of the soft object, in the world.
void doubt_soft_start(const WorldDescription& world,
                      const WorldSoftObject& soft,
                      const physics::SoftMesh& mesh,
                      std::vector<std::string>& lines) {
    geometry::Aabb around;
    for (const Eigen::Vector3d& node : mesh.nodes) around.add(node);
    const geometry::SurfaceTree surface({mesh.nodes, mesh.topology.triangles});
    for (const WorldObject& object : world.objects) {
        const physics::RigidObject rigid = to_rigid(object);
        // what it is tied to does not touch it
        if (!may_be_in(around, rigid) || is_tied(soft, object)) continue;
        const double depth_m = physics::overlap_m(soft.object, rigid);
        // wholly inside, it touches no node; a cloth has no inside
        const bool is_open = soft.object.shape == physics::SoftShape::kCloth ||
                             rigid.shape == physics::ObjectShape::kPlane;
        const double inside_m = is_open ? 0.0 : physics::depth_m(rigid, surface);
        if (depth_m <= kDeepSoft_m && inside_m > kDeepSoft_m) {
            lines.push_back(fmt::format(
                "soft_looks_wrong name={} reason=\"{} starts {:.2f} m inside it, and may stay "
                "there: move one of them with position_m\"",
                soft.name,
                object.name,
                inside_m));
            return;
        }
        if (depth_m <= kDeepSoft_m && physics::is_skewered(soft.object, rigid)) {
            lines.push_back(fmt::format(
                "soft_looks_wrong name={} reason=\"starts with {} through it, between its nodes, "
                "and stays so: move one of them with position_m\"",
                soft.name,
                object.name));
            return;
        }
        if (depth_m <= kDeepSoft_m) continue;
        const auto depth_in = [&](const geometry::SurfaceTree& bodies) {
            physics::SoftObject moved = soft.object;
            moved.world_from_object =
                object.rigid.world_from_object.inverse() * soft.object.world_from_object;
            return physics::depth_m(moved, bodies);
        };
        const bool is_movable = rigid.mass_kg > 0.0;
        const bool has_ends = soft.object.shape == physics::SoftShape::kRope;
        lines.push_back(
            fmt::format("soft_looks_wrong name={} reason=\"starts {:.2f} m inside {}, which {}: "
                        "{}move it with position_m{}\"",
                        soft.name,
                        depth_m,
                        object.name,
                        is_movable ? "throws both apart" : "is fixed",
                        cause_in_hollow(object, depth_m, depth_in),
                        is_movable && has_ends ? ", or tie it there with tied and tied_to" : ""));
        return;
    }
}

// `mesh` is that of the soft object, in its frame.
void doubt_ties(const WorldDescription& world,
                const WorldSoftObject& soft,
                const physics::SoftMesh& mesh,
                std::vector<std::string>& lines) {
    for (const physics::SoftPin& pin : soft.object.pins) {
        const WorldObject* object = object_of(world, pin.object_id);
        if (object == nullptr) continue;
        double nearest_m = std::numeric_limits<double>::infinity();
        Eigen::Vector3d place_m = Eigen::Vector3d::Zero();
        for (const std::uint32_t node : physics::nodes_at(mesh, soft.object, pin)) {
            const Eigen::Vector3d at_m = physics::start_of_node(soft.object, mesh, node);
            const double far_m = distance_m(at_m, object->rigid);
            if (far_m >= nearest_m) continue;
            nearest_m = far_m;
            place_m = at_m;
        }
        if (nearest_m <= kFarTie_m) continue;
        lines.push_back(
            fmt::format("soft_looks_wrong name={} reason=\"tied at [{:.2f}, {:.2f}, {:.2f}] is "
                        "{:.2g} m away from {}; move one of them with position_m\"",
                        soft.name,
                        place_m.x(),
                        place_m.y(),
                        place_m.z(),
                        nearest_m,
                        object->name));
    }
}

}  // namespace

void doubt_soft(const WorldDescription& world, std::vector<std::string>& lines) {
    for (const WorldSoftObject& soft : world.soft) {
        physics::SoftMesh mesh = physics::make_soft_mesh(soft.object);
        doubt_ties(world, soft, mesh, lines);
        for (std::size_t i = 0; i < mesh.nodes.size(); ++i)
            mesh.nodes[i] = physics::start_of_node(soft.object, mesh, i);
        if (!doubt_pins(world, soft, lines)) doubt_soft_start(world, soft, mesh, lines);
    }
}

}  // namespace atrium::world_server
