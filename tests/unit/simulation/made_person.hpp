#pragma once

#include <Eigen/Geometry>

#include <array>
#include <filesystem>
#include <string>
#include <vector>

namespace atrium::simulation::made {

/// Whose names the bones of a made person have.
enum class Names { kMixamo, kBiped, kCmu, kUnknown };

/// Options of a person that tests write into a model file.
struct PersonOptions {
    Names names = Names::kMixamo;
    double units_per_m = 1.0;
    double fbx_unit_scale = 100.0;  // centimetres per unit, as FBX states it
    bool is_z_up = false;           // coordinates of the file; FBX states it
    bool is_mesh_turned = false;    // FBX: the mesh has a node with its own rotation and scale
    bool has_skin = true;
    bool has_animation = true;  // the left arm is raised by 90 degrees in a second
    bool arms_hang = false;     // rests in an A pose, else in a T pose
    bool is_lying = false;      // in the animation, while the skeleton rests upright
    Eigen::Vector3d colour{0.2, 0.4, 0.8};
    std::string picture;  // path as written into the file; empty: none
    std::string opacity_picture;
};

constexpr std::size_t kNumJoints = 21;

/// A joint of the rest pose: +Y up, +Z forwards, metres.
struct Joint {
    std::string name;
    int parent = -1;
    Eigen::Vector3d at;
    Eigen::Vector3d end;  // of the limb that it moves
    double radius = 0.05;
};

/// The skeleton, 1.80 m tall. The left upper arm is joint `kLeftArm`.
std::vector<Joint> joints_of(const PersonOptions& options);
constexpr std::size_t kLeftArm = 6;

/// Closed limbs of the skeleton, about 75 litres, each moved by one joint.
struct Body {
    std::vector<Eigen::Vector3d> positions;
    std::vector<Eigen::Vector3d> normals;
    std::vector<Eigen::Vector2d> texture_places;
    std::vector<std::size_t> joint;  // per vertex
    std::vector<std::array<int, 3>> triangles;
};
Body body_of(const std::vector<Joint>& joints);

/// Writes a glTF file with the buffer inside.
void write_gltf(const std::filesystem::path& file, const PersonOptions& options);

/// Writes an ASCII FBX 7.4 file as 3ds Max does for a biped: bones point along their X, and their
/// rest rotations are PreRotations.
void write_fbx(const std::filesystem::path& file, const PersonOptions& options);

/// Writes a BVH motion of 1 s at 30 Hz, in centimetres.
void write_bvh(const std::filesystem::path& file, const PersonOptions& options);

}  // namespace atrium::simulation::made
