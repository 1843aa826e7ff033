#include "world_server/description/load_doubts.hpp"

#include "core/geometry/aabb.hpp"
#include "world_server/description/start_doubts.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <map>
#include <set>
#include <utility>

namespace atrium::world_server {
namespace {

// In units of the carrier's mass, at 120 Hz; four times as much at twice the rate. Measured: towers
// stood with 150 and fell with 300 (bodies that carry several), chains of 12 links of 10 cm held
// 40 and tore with 60, those of 30 cm held 100.
constexpr double kLargestStackLoad = 100.0;
constexpr double kLargestChainLoad = 50.0;
constexpr double kTouch_m = 0.01;
constexpr double kFalls_m = 0.1;  // as far as cargo is put above what shall carry it

double largest_at(double tick_hz, double largest_at_120_hz) {
    return largest_at_120_hz * (tick_hz / 120.0) * (tick_hz / 120.0);
}

// What an object carries.
struct Load {
    double mass_kg = 0.0;
    const WorldObject* heaviest = nullptr;  // of what it carries

    void add(double more_kg, const WorldObject* object) {
        mass_kg += more_kg;
        if (heaviest == nullptr || object->rigid.mass_kg > heaviest->rigid.mass_kg)
            heaviest = object;
    }
};

void doubt(const WorldObject& object,
           const Load& load,
           double tick_hz,
           double largest_at_120_hz,
           const char* what,
           std::vector<std::string>& lines) {
    const double ratio = load.mass_kg / object.rigid.mass_kg;
    const double largest = largest_at(tick_hz, largest_at_120_hz);
    if (ratio <= largest) return;
    std::string faster;
    for (const double hz : {240.0, 360.0, 480.0}) {
        if (hz <= tick_hz || ratio > largest_at(hz, largest_at_120_hz)) continue;
        faster = fmt::format(", or run with world.tick_hz = {}", hz);
        break;
    }
    lines.push_back(fmt::format(
        "object_looks_wrong name={} reason=\"its {:.3g} kg carry {:.3g} kg, {:.0f} times as much; "
        "the heaviest is {} with {:.3g} kg: {} above {:.0f} times at world.tick_hz = {}\" "
        "advice=\"make {}{} at least {:.2g} kg{}\"",
        object.name,
        object.rigid.mass_kg,
        load.mass_kg,
        ratio,
        load.heaviest->name,
        load.heaviest->rigid.mass_kg,
        what,
        largest,
        tick_hz,
        object.name,
        largest_at_120_hz == kLargestChainLoad ? " and the links like it" : "",
        1.05 * load.mass_kg / largest,
        faster));
}

bool rests_on(const geometry::Aabb& upper, const geometry::Aabb& lower, double air_m) {
    for (int axis = 0; axis < 2; ++axis) {
        if (upper.min[axis] >= lower.max[axis] || lower.min[axis] >= upper.max[axis]) return false;
    }
    const double gap_m = upper.min.z() - lower.max.z();
    return gap_m >= -kTouch_m && gap_m <= air_m;
}

bool are_joined(const WorldDescription& world, std::uint32_t a, std::uint32_t b) {
    return std::ranges::any_of(world.joints, [&](const physics::Joint& joint) {
        return (joint.a == a && joint.b == b) || (joint.a == b && joint.b == a);
    });
}

struct Layer {
    const WorldObject* object;
    geometry::Aabb box;
    Load load{};
};

// The objects and what they carry. From the top down, each gives its mass and what it carries to
// those below with at most `air_m` between them, in equal parts.
std::vector<Layer> layers_of(const WorldDescription& world, double air_m) {
    std::vector<Layer> layers;
    for (const WorldObject& object : world.objects) {
        if (object.rigid.shape != physics::ObjectShape::kPlane)
            layers.push_back({&object, start_box_of(to_rigid(object))});
    }
    std::ranges::stable_sort(
        layers, [](const Layer& a, const Layer& b) { return a.box.min.z() > b.box.min.z(); });
    for (std::size_t i = 0; i < layers.size(); ++i) {
        const Layer& upper = layers[i];
        const physics::RigidObject& rigid = upper.object->rigid;
        if (rigid.mass_kg == 0.0) continue;
        std::vector<Layer*> below;
        for (std::size_t k = i + 1; k < layers.size(); ++k) {
            if (rests_on(upper.box, layers[k].box, air_m) &&
                !are_joined(world, rigid.id, layers[k].object->rigid.id))
                below.push_back(&layers[k]);
        }
        for (Layer* lower : below) {
            const double num = static_cast<double>(below.size());
            lower->load.add((rigid.mass_kg + upper.load.mass_kg) / num, upper.object);
            if (upper.load.heaviest != nullptr) lower->load.add(0.0, upper.load.heaviest);
        }
    }
    return layers;
}

void doubt_stacks(const WorldDescription& world, double tick_hz, std::vector<std::string>& lines) {
    for (const Layer& layer : layers_of(world, kTouch_m)) {
        if (layer.object->rigid.mass_kg == 0.0 || layer.load.heaviest == nullptr) continue;
        doubt(*layer.object, layer.load, tick_hz, kLargestStackLoad, "it slides or falls", lines);
    }
}

using Neighbours = std::map<std::uint32_t, std::set<std::uint32_t>>;

// Adds the objects that hang on `link` alone beyond its neighbour `first`; none if they are held by
// something fixed, too.
Load load_beyond(const Neighbours& neighbours,
                 const std::map<std::uint32_t, const WorldObject*>& moving,
                 std::uint32_t link,
                 std::uint32_t first) {
    std::set<std::uint32_t> seen{link, first};
    std::vector<std::uint32_t> waiting{first};
    Load load;
    while (!waiting.empty()) {
        const auto object = moving.find(waiting.back());
        if (object == moving.end()) return {};  // fixed, or the world
        waiting.pop_back();
        load.add(object->second->rigid.mass_kg, object->second);
        for (const std::uint32_t next : neighbours.at(object->first))
            if (seen.insert(next).second) waiting.push_back(next);
    }
    return load;
}

// One line for each chain: its link that carries the most in relation to its mass.
void doubt_chains(const WorldDescription& world, double tick_hz, std::vector<std::string>& lines) {
    std::map<std::uint32_t, const WorldObject*> moving;
    for (const WorldObject& object : world.objects)
        if (object.rigid.mass_kg != 0.0) moving[object.rigid.id] = &object;
    Neighbours neighbours;
    for (const physics::Joint& joint : world.joints) {
        neighbours[joint.a].insert(joint.b);
        neighbours[joint.b].insert(joint.a);
    }
    std::map<const WorldObject*, std::pair<const WorldObject*, Load>> worst;  // by heaviest
    for (const auto& [id, link] : moving) {
        if (!neighbours.contains(id)) continue;
        Load load;
        bool is_held = false;
        for (const std::uint32_t next : neighbours.at(id)) {
            const Load beyond = load_beyond(neighbours, moving, id, next);
            if (beyond.heaviest == nullptr)
                is_held = true;
            else
                load.add(beyond.mass_kg, beyond.heaviest);
        }
        if (!is_held || load.heaviest == nullptr) continue;
        auto& [known, known_load] = worst[load.heaviest];
        if (known == nullptr ||
            load.mass_kg / link->rigid.mass_kg > known_load.mass_kg / known->rigid.mass_kg) {
            known = link;
            known_load = load;
        }
    }
    std::map<std::uint32_t, std::pair<const WorldObject*, Load>> in_order;
    for (const auto& [heaviest, found] : worst) in_order[found.first->rigid.id] = found;
    for (const auto& [id, found] : in_order)
        doubt(*found.first,
              found.second,
              tick_hz,
              kLargestChainLoad,
              "its joints stretch or tear",
              lines);
}

double middle_m(const WorldObject& object) { return start_box_of(to_rigid(object)).centre().z(); }

// Something heavy joined to something light below it: a lid of lead on a box. Passes over what
// `lines` name already.
void doubt_pairs(const WorldDescription& world, double tick_hz, std::vector<std::string>& lines) {
    for (const physics::Joint& joint : world.joints) {
        const WorldObject* light = object_of(world, joint.a);
        const WorldObject* heavy = object_of(world, joint.b);
        if (light == nullptr || heavy == nullptr || joint.kind == physics::JointKind::kSpring)
            continue;
        if (light->rigid.mass_kg > heavy->rigid.mass_kg) std::swap(light, heavy);
        const std::string named = fmt::format("name={} ", light->name);
        const bool is_named = std::ranges::any_of(
            lines, [&](const std::string& line) { return line.find(named) != line.npos; });
        if (light->rigid.mass_kg == 0.0 || is_named || middle_m(*heavy) < middle_m(*light))
            continue;
        doubt(*light,
              {heavy->rigid.mass_kg, heavy},
              tick_hz,
              kLargestStackLoad,
              "their joint tears",
              lines);
    }
}

}  // namespace

std::map<std::uint32_t, double> carried_kg(const WorldDescription& world) {
    std::map<std::uint32_t, double> carried;
    for (const Layer& layer : layers_of(world, kFalls_m))
        carried[layer.object->rigid.id] = layer.load.mass_kg;
    return carried;
}

void doubt_loads(const WorldDescription& world, double tick_hz, std::vector<std::string>& lines) {
    std::vector<std::string> loads;
    doubt_stacks(world, tick_hz, loads);
    doubt_chains(world, tick_hz, loads);
    doubt_pairs(world, tick_hz, loads);
    lines.insert(lines.end(), loads.begin(), loads.end());
}

}  // namespace atrium::world_server
