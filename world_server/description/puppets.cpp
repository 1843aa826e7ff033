#include "world_server/description/puppets.hpp"

#include "world_server/description/puppet.hpp"
#include "world_server/description/shared_entries.hpp"

#include <algorithm>
#include <string>

namespace atrium::world_server {
namespace {

constexpr std::size_t kMaxPuppetName = 48;  // the part's name adds up to 15 characters

bool is_taken(const std::vector<WorldObject>& objects, const std::string& name) {
    return std::any_of(objects.begin(), objects.end(), [&](const WorldObject& object) {
        return object.name == name || object.name.starts_with(name + ".");
    });
}

PuppetDescription read_puppet(config::TableReader& reader, const Materials& materials) {
    PuppetDescription puppet;
    read_name(reader, puppet.name);
    if (puppet.name.size() > kMaxPuppetName)
        reader.reject("name", "must be at most 48 characters for a puppet");
    read_pose(reader, puppet.world_from_puppet);
    reader.read("height_m", puppet.height_m, {0.4, 2.0});
    if (reader.has("material")) {
        const Material material = read_material(reader, materials);
        puppet.friction = material.friction;
        puppet.density_kg_per_m3 = material.density_kg_per_m3.value_or(puppet.density_kg_per_m3);
    }
    read_density(reader, puppet.density_kg_per_m3);
    reader.read("friction", puppet.friction, {0.0, 10.0});
    reader.read("colour", puppet.colour.data(), 3, {0.0, 1.0});
    reader.read("limb_colour", puppet.limb_colour.data(), 3, {0.0, 1.0});
    reader.read("head_colour", puppet.head_colour.data(), 3, {0.0, 1.0});
    reader.read("string_m", puppet.string_m, {0.0, 10.0});
    return puppet;
}

}  // namespace

void read_puppets(config::TableReader& reader,
                  const Materials& materials,
                  std::vector<WorldObject>& objects,
                  std::vector<physics::Joint>& joints) {
    for (config::TableReader& table : reader.tables("puppet")) {
        const PuppetDescription description = read_puppet(table, materials);
        if (is_taken(objects, description.name))
            table.reject("name", "must be unique among the objects and puppets");
        Puppet puppet = make_puppet(description, static_cast<std::uint32_t>(objects.size() + 1));
        for (const WorldObject& part : puppet.parts) {
            const auto problem = physics::find_problem(to_rigid(part));
            if (problem) table.reject(std::string(problem->field), std::string(problem->allowed));
        }
        objects.insert(objects.end(), puppet.parts.begin(), puppet.parts.end());
        joints.insert(joints.end(), puppet.joints.begin(), puppet.joints.end());
    }
}

}  // namespace atrium::world_server
