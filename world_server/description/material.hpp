#pragma once

#include "core/config/table_reader.hpp"

#include <Eigen/Core>

#include <map>
#include <optional>
#include <string>

namespace atrium::world_server {

/// Default properties of an object, used where its own table has no entry.
struct Material {
    std::optional<double> density_kg_per_m3{};
    double friction = 0.6;
    double restitution = 0.2;
    double rolling_friction_m = 0.0005;
    Eigen::Vector3d colour = Eigen::Vector3d::Constant(0.7);  // linear RGB in [0, 1]
    std::string texture{};                                    // file; empty: none
};

using Materials = std::map<std::string, Material>;

/// Returns wood, rubber, plastic, foam, cardboard, steel and stone.
const Materials& built_in_materials();

/// Returns the built-in materials and those of `[[material]]`, which may replace built-in ones.
/// Problems go to `reader`.
Materials read_materials(config::TableReader& reader);

/// Returns the material named by `material` in a table, or the default.
Material read_material(config::TableReader& reader, const Materials& materials);

/// Reads `density_kg_per_m3`. One in g/cm^3 is out of its range.
void read_density(config::TableReader& reader, double& density_kg_per_m3);

/// Reads `mass_kg`, or computes the mass of the volume from `density_kg_per_m3` or the material.
/// One of the three is required. `of_zero` tells in the message about a missing one what a mass of
/// 0 does.
void read_mass(config::TableReader& reader,
               const Material& material,
               double volume_m3,
               const char* of_zero,
               double& mass_kg);

}  // namespace atrium::world_server
