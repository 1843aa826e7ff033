#pragma once

#include "core/config/table_reader.hpp"

#include <Eigen/Core>

#include <map>
#include <optional>
#include <string>

namespace atrium::world_server {

/// What a thing is made of: what an object has where its own table does not say otherwise.
struct Material {
    std::optional<double> density_kg_per_m3{};
    double friction = 0.6;
    double restitution = 0.2;
    double rolling_friction_m = 0.0005;
    Eigen::Vector3d colour = Eigen::Vector3d::Constant(0.7);  // linear RGB in [0, 1]
    std::string texture{};                                    // a file; empty: none
};

using Materials = std::map<std::string, Material>;

/// wood, rubber, plastic, foam, cardboard, steel, stone.
const Materials& built_in_materials();

/// The built-in materials and those of `[[material]]`, which may replace them. Problems are kept by
/// `reader`.
Materials read_materials(config::TableReader& reader);

/// What `material` names in a table; the default where it names none.
Material read_material(config::TableReader& reader, const Materials& materials);

/// `mass_kg`, or what `density_kg_per_m3` or the material makes of a volume. One of the three must
/// be there.
void read_mass(config::TableReader& reader,
               const Material& material,
               double volume_m3,
               double& mass_kg);

}  // namespace atrium::world_server
