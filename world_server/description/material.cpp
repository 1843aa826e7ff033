#include "world_server/description/material.hpp"

#include "world_server/description/shared_entries.hpp"

#include <fmt/format.h>

#include <set>
#include <vector>

namespace atrium::world_server {

const Materials& built_in_materials() {
    // densities and bounce from handbooks; friction against the same material; the rolling lever
    // brings a hand-sized ball to rest within metres
    static const Materials kMaterials{
        {"wood", {600.0, 0.5, 0.3, 0.0005, {0.42, 0.26, 0.13}}},
        {"rubber", {1100.0, 0.9, 0.7, 0.002, {0.08, 0.08, 0.09}}},
        {"plastic", {950.0, 0.4, 0.4, 0.0005, {0.70, 0.10, 0.08}}},
        {"foam", {40.0, 0.7, 0.3, 0.004, {0.80, 0.68, 0.25}}},
        {"cardboard", {120.0, 0.5, 0.1, 0.002, {0.45, 0.32, 0.19}}},
        {"steel", {7800.0, 0.4, 0.4, 0.0002, {0.45, 0.46, 0.48}}},
        {"stone", {2500.0, 0.6, 0.2, 0.001, {0.36, 0.35, 0.33}}},
    };
    return kMaterials;
}

Materials read_materials(config::TableReader& reader) {
    Materials materials = built_in_materials();
    std::set<std::string> names;
    for (config::TableReader& table : reader.tables("material")) {
        std::string name;
        read_name(table, name);
        if (!names.insert(name).second) table.reject("name", "must be unique among the materials");
        Material material;
        if (table.has("density_kg_per_m3")) {
            double density = 0.0;
            read_density(table, density);
            material.density_kg_per_m3 = density;
        }
        table.read("friction", material.friction, {0.0, 10.0});
        table.read("restitution", material.restitution, {0.0, 1.0});
        table.read("rolling_friction_m", material.rolling_friction_m, {0.0, 1.0});
        table.read("colour", material.colour.data(), 3, {0.0, 1.0});
        read_texture(table, material.texture);
        materials[name] = material;
    }
    return materials;
}

void read_density(config::TableReader& reader, double& density_kg_per_m3) {
    constexpr double kLeast = 14.0;  // mercury has 13.5 g/cm^3, the lightest foam 15 kg/m^3
    constexpr double kMost = 30'000.0;
    reader.read("density_kg_per_m3", density_kg_per_m3);
    if (density_kg_per_m3 >= kLeast && density_kg_per_m3 <= kMost) return;
    reader.reject("density_kg_per_m3",
                  fmt::format("must be {} to {} (water has 1000): multiply g/cm^3 by 1000, and "
                              "write mass_kg for what is filled with air",
                              kLeast,
                              kMost));
}

Material read_material(config::TableReader& reader, const Materials& materials) {
    std::vector<std::string> names;
    for (const auto& [name, material] : materials) names.push_back(name);
    std::string name;
    reader.read("material", name, names);
    const auto found = materials.find(name);
    return found == materials.end() ? Material{} : found->second;
}

void read_mass(config::TableReader& reader,
               const Material& material,
               double volume_m3,
               const char* of_zero,
               double& mass_kg) {
    const bool has_mass = reader.has("mass_kg");
    const bool has_density = reader.has("density_kg_per_m3");
    reader.read("mass_kg", mass_kg, {0.0, 1e4});
    if (has_mass && !has_density) return;
    if (has_mass)
        return reader.reject("density_kg_per_m3", "must not be set together with mass_kg");
    if (!has_density && !material.density_kg_per_m3) {
        return reader.reject(
            "mass_kg",
            fmt::format("is missing: set it{}, density_kg_per_m3, or a material with a density",
                        of_zero));
    }
    double density = material.density_kg_per_m3.value_or(0.0);
    read_density(reader, density);
    mass_kg = density * volume_m3;
}

}  // namespace atrium::world_server
