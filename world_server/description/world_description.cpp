#include "world_server/description/world_description.hpp"

#include "world_server/description/joints.hpp"
#include "world_server/description/material.hpp"
#include "world_server/description/objects.hpp"
#include "world_server/description/puppets.hpp"
#include "world_server/description/surroundings.hpp"
#include "world_server/description/texture_fingerprints.hpp"

#include <algorithm>

namespace atrium::world_server {
namespace {

std::string place_of_key(const config::TableReader& reader, const std::string& key) {
    return reader.has(key) ? reader.where(key) : "";
}

}  // namespace

const WorldObject* object_of(const WorldDescription& world, std::uint32_t id) {
    const auto found = std::ranges::find(
        world.objects, id, [](const WorldObject& object) { return object.rigid.id; });
    return found == world.objects.end() ? nullptr : &*found;
}

void read_world(config::TableReader& reader, WorldDescription& description) {
    description.objects_at = reader.where("object");
    description.rates_at =
        place_of_key(reader, reader.has("world.send_hz") ? "world.send_hz" : "world.tick_hz");
    description.max_objects_at = place_of_key(reader, "world.max_objects");
    description.max_sites_at = place_of_key(reader, "world.max_sites");
    std::filesystem::path models = reader.folder().empty() ? "." : reader.folder();
    reader.read("world.models", models);
    reader.set_folder(models);
    description.models_folder = models;
    reader.read("world.gravity", description.world.gravity.data(), 3, {-100.0, 100.0});
    read_bounds(reader, description.world);
    const Materials materials = read_materials(reader);
    read_objects(reader, materials, description.objects);
    read_puppets(reader, materials, description.objects, description.joints);
    description.soft = read_soft_objects(reader, materials, description.objects);
    read_joints(reader, description.objects, description.joints);
    read_scenery(reader, materials, description.scenery);
    read_placements(reader, description.placements);
    read_rights(reader, description.rights);
    fingerprint_textures(description);
}

}  // namespace atrium::world_server
