#pragma once

#include "core/config/table_reader.hpp"
#include "core/geometry/rigid_transform.hpp"

#include <filesystem>
#include <numbers>
#include <string>

/// What the tables of a world file have in common. Problems are kept by `reader`.
namespace atrium::world_server {

inline constexpr double kRadPerDeg = std::numbers::pi / 180.0;
inline constexpr config::Range kPositionRange{-1000.0, 1000.0};  // [m]
inline constexpr config::Range kSizeRange{0.0, 1000.0};          // [m]; the physics narrows it

/// `name`, required.
void read_name(config::TableReader& reader, std::string& name);
/// `position_m` and `roll_pitch_yaw_deg`, about x, then y, then z of the world.
void read_pose(config::TableReader& reader, geometry::RigidTransform& world_from_object);
/// `texture`: a picture of the file's folder (bus::is_valid_model_file) that must be there.
void read_texture(config::TableReader& reader, std::string& texture);
/// `model`, required, and `scale`: a model of the file's folder. False where it is not a name of
/// one.
bool read_model_name(config::TableReader& reader, std::string& model, double& scale);

}  // namespace atrium::world_server
