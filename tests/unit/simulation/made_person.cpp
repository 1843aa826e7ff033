#include "tests/unit/simulation/made_person.hpp"

#include <cmath>
#include <map>
#include <numbers>

namespace atrium::simulation::made {
namespace {

using Eigen::Vector3d;

// Names of the joints: Mixamo, 3ds Max's biped, CMU's BVH files.
constexpr std::array<std::array<const char*, 3>, kNumJoints> kNames{{
    {"mixamorig:Hips", "Bip01 Pelvis", "Hips"},
    {"mixamorig:Spine", "Bip01 Spine", "LowerBack"},
    {"mixamorig:Spine1", "Bip01 Spine1", "Spine"},
    {"mixamorig:Neck", "Bip01 Neck", "Neck"},
    {"mixamorig:Head", "Bip01 Head", "Head"},
    {"mixamorig:LeftShoulder", "Bip01 L Clavicle", "LeftShoulder"},
    {"mixamorig:LeftArm", "Bip01 L UpperArm", "LeftArm"},
    {"mixamorig:LeftForeArm", "Bip01 L Forearm", "LeftForeArm"},
    {"mixamorig:LeftHand", "Bip01 L Hand", "LeftHand"},
    {"mixamorig:RightShoulder", "Bip01 R Clavicle", "RightShoulder"},
    {"mixamorig:RightArm", "Bip01 R UpperArm", "RightArm"},
    {"mixamorig:RightForeArm", "Bip01 R Forearm", "RightForeArm"},
    {"mixamorig:RightHand", "Bip01 R Hand", "RightHand"},
    {"mixamorig:LeftUpLeg", "Bip01 L Thigh", "LeftUpLeg"},
    {"mixamorig:LeftLeg", "Bip01 L Calf", "LeftLeg"},
    {"mixamorig:LeftFoot", "Bip01 L Foot", "LeftFoot"},
    {"mixamorig:LeftToeBase", "Bip01 L Toe0", "LeftToeBase"},
    {"mixamorig:RightUpLeg", "Bip01 R Thigh", "RightUpLeg"},
    {"mixamorig:RightLeg", "Bip01 R Calf", "RightLeg"},
    {"mixamorig:RightFoot", "Bip01 R Foot", "RightFoot"},
    {"mixamorig:RightToeBase", "Bip01 R Toe0", "RightToeBase"},
}};

std::string name_of(std::size_t joint, Names names) {
    if (names == Names::kUnknown) return "node_" + std::to_string(joint);
    return kNames[joint][static_cast<std::size_t>(names)];
}

// Of one side; the other is its mirror image.
std::vector<Joint> arm(double side, bool hangs) {
    const Vector3d shoulder(0.19 * side, 1.44, 0);
    const Vector3d along = hangs ? Vector3d(0.5 * side, -0.866, 0) : Vector3d(side, 0, 0);
    const Vector3d elbow = shoulder + 0.28 * along;
    const Vector3d wrist = elbow + 0.25 * along;
    return {{"", 2, {0.04 * side, 1.44, 0}, shoulder, 0.06},
            {"", 5, shoulder, elbow, 0.05},
            {"", 6, elbow, wrist, 0.042},
            {"", 7, wrist, wrist + 0.16 * along, 0.04}};
}

std::vector<Joint> leg(double side) {
    const double x = 0.1 * side;
    return {{"", 0, {x, 0.92, 0}, {x, 0.50, 0}, 0.095},
            {"", 13, {x, 0.50, 0}, {x, 0.08, 0}, 0.07},
            {"", 14, {x, 0.08, 0}, {x, 0.05, 0.14}, 0.05},
            {"", 15, {x, 0.05, 0.14}, {x, 0.05, 0.20}, 0.045}};
}

// Adds an ellipsoid around the segment, which it exceeds by a third of its radius.
void add_limb(const Joint& joint, std::size_t index, Body& body) {
    constexpr int kRings = 12;
    constexpr int kSides = 16;
    const Vector3d axis = (joint.end - joint.at).normalized();
    const Vector3d side = axis.unitOrthogonal();
    const Vector3d other = axis.cross(side);
    const Vector3d centre = 0.5 * (joint.at + joint.end);
    const double half = 0.5 * (joint.end - joint.at).norm() + joint.radius / 3;
    const int first = static_cast<int>(body.positions.size());
    for (int ring = 0; ring <= kRings; ++ring) {
        const double theta = std::numbers::pi * ring / kRings;
        // flatter than an ellipsoid, so that joints overlap
        const double wide = std::pow(std::sin(theta), 0.4);
        for (int k = 0; k <= kSides; ++k) {
            const double phi = 2 * std::numbers::pi * (k % kSides) / kSides;
            const Vector3d out = std::cos(phi) * side + std::sin(phi) * other;
            body.positions.push_back(centre - half * std::cos(theta) * axis +
                                     joint.radius * wide * out);
            body.normals.push_back((std::sin(theta) * out - std::cos(theta) * axis).normalized());
            body.texture_places.emplace_back(static_cast<double>(k) / kSides,
                                             static_cast<double>(ring) / kRings);
            body.joint.push_back(index);
        }
    }
    for (int ring = 0; ring < kRings; ++ring) {
        for (int k = 0; k < kSides; ++k) {
            const int a = first + ring * (kSides + 1) + k;
            const int b = a + kSides + 1;
            if (ring > 0) body.triangles.push_back({a, a + 1, b + 1});
            if (ring + 1 < kRings) body.triangles.push_back({a, b + 1, b});
        }
    }
}

}  // namespace

std::vector<Joint> joints_of(const PersonOptions& options) {
    std::vector<Joint> joints{{"", -1, {0, 0.95, 0}, {0, 1.08, 0}, 0.15},
                              {"", 0, {0, 1.08, 0}, {0, 1.26, 0}, 0.145},
                              {"", 1, {0, 1.26, 0}, {0, 1.48, 0}, 0.165},
                              {"", 2, {0, 1.48, 0}, {0, 1.57, 0}, 0.055},
                              {"", 3, {0, 1.57, 0}, {0, 1.768, 0}, 0.095}};
    const auto add = [&](std::vector<Joint> limb, int first_parent, int chain) {
        for (std::size_t i = 0; i < limb.size(); ++i) {
            limb[i].parent = i == 0 ? first_parent : chain + static_cast<int>(i) - 1;
            joints.push_back(limb[i]);
        }
    };
    add(arm(1, options.arms_hang), 2, 5);
    add(arm(-1, options.arms_hang), 2, 9);
    add(leg(1), 0, 13);
    add(leg(-1), 0, 17);
    for (std::size_t i = 0; i < joints.size(); ++i) joints[i].name = name_of(i, options.names);
    return joints;
}

Body body_of(const std::vector<Joint>& joints) {
    Body body;
    for (std::size_t i = 0; i < joints.size(); ++i) add_limb(joints[i], i, body);
    return body;
}

}  // namespace atrium::simulation::made
