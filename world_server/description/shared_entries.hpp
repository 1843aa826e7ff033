#pragma once

#include "core/config/table_reader.hpp"
#include "core/geometry/rigid_transform.hpp"
#include "world_server/description/world_object.hpp"

#include <Eigen/Core>

#include <filesystem>
#include <functional>
#include <numbers>
#include <string>
#include <vector>

/// Reads the entries that several tables of a world file share. Problems go to `reader`.
namespace atrium::world_server {

inline constexpr double kRadPerDeg = std::numbers::pi / 180.0;
inline constexpr config::Range kPositionRange{-1000.0, 1000.0};  // [m]
/// [m]. The physics allows less and rejects more; 20 m in millimetres get its advice (ask_unit).
inline constexpr config::Range kSizeRange{0.0, 20000.0};

/// Returns the path of a file that the world file names, without "./".
std::filesystem::path file_of(const config::TableReader& reader, const std::string& name);

/// Reads `name`; required.
void read_name(config::TableReader& reader, std::string& name);
/// Reads `position_m` and `roll_pitch_yaw_deg`: rotations about x, then y, then z of the world.
void read_pose(config::TableReader& reader, geometry::RigidTransform& world_from_object);
/// Reads `texture`: an existing picture in the folder of models (bus::is_valid_model_file).
void read_texture(config::TableReader& reader, std::string& texture);
/// Reads `colour`, after `texture` and the colour of `material`. If the table has none of the
/// three, the colour is that of the model, if its file states one alone. `own_colours`: those of
/// the file; emptied if they do not matter.
void read_colour(config::TableReader& reader,
                 const std::string& texture,
                 std::vector<Eigen::Vector3d>& own_colours,
                 Eigen::Vector3d& colour);
/// Reads `model`, required, and `scale`: a model in the folder of models. False if the name is
/// not valid.
bool read_model_name(config::TableReader& reader, std::string& model, double& scale);
/// Rejects the file of `model`. If it does not exist, names a file that may be meant.
void reject_model(config::TableReader& reader, Error error);
/// Returns the extents of a model, with what `scale` makes of other units.
std::string size_advice(const Eigen::Vector3d& size_m);

/// Returns "; are these centimetres? Divide by 100" or the like for a size that is not allowed, or
/// nothing if that does not make it right. `allows` tells whether the physics allows a size.
std::string ask_unit(const Eigen::Vector3d& size_m,
                     const std::function<bool(const Eigen::Vector3d& size_m)>& allows);

/// "; its volume of 125 m^3 gives 75000 kg: write mass_kg", for masses that follow from a density.
std::string mass_advice(double volume_m3, double mass_kg);

/// Returns the object of that name; null if there is none.
const WorldObject* find_object(const std::vector<WorldObject>& objects, const std::string& name);
/// Returns " (did you mean door?)", or nothing.
std::string object_meant_by(const std::string& written, const std::vector<WorldObject>& objects);

}  // namespace atrium::world_server
