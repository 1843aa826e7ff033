#include "simulation/body_shape.hpp"

#include "simulation/surface_nets.hpp"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <limits>

namespace atrium::simulation {
namespace {

using Eigen::Vector3d;

constexpr double kCellM = 0.0175;

class PartList {
public:
    void cone(Bone bone,
              const Vector3d& a,
              const Vector3d& b,
              double radius_a_m,
              double radius_b_m,
              double blend_m) {
        parts.push_back({.bone = bone,
                         .a = a,
                         .b = b,
                         .radius_a_m = radius_a_m,
                         .radius_b_m = radius_b_m,
                         .radii_m = Vector3d::Zero(),
                         .part_from_body = Eigen::Matrix3d::Identity(),
                         .blend_m = blend_m});
    }
    void ellipsoid(Bone bone,
                   const Vector3d& centre,
                   const Vector3d& radii_m,
                   double blend_m,
                   const Eigen::Matrix3d& part_from_body = Eigen::Matrix3d::Identity()) {
        parts.push_back({.bone = bone,
                         .a = centre,
                         .b = centre,
                         .is_ellipsoid = true,
                         .radii_m = radii_m,
                         .part_from_body = part_from_body,
                         .blend_m = blend_m});
    }
    std::vector<BodyPart> parts;
};

void add_trunk(PartList& list, double girth) {
    const Vector3d thick(girth, girth, 1.0);
    list.ellipsoid(
        kChest, {0.0, 0.0, 1.275}, thick.cwiseProduct(Vector3d(0.160, 0.105, 0.185)), 0.03);
    list.ellipsoid(
        kPelvis, {0.0, 0.008, 1.08}, thick.cwiseProduct(Vector3d(0.138, 0.104, 0.17)), 0.05);
    list.ellipsoid(
        kPelvis, {0.0, -0.012, 0.945}, thick.cwiseProduct(Vector3d(0.160, 0.116, 0.125)), 0.05);
}

void add_head(PartList& list, const Look& look) {
    list.cone(kHead, {0.0, -0.012, 1.43}, {0.0, 0.004, 1.54}, 0.057, 0.050, 0.035);
    list.ellipsoid(kHead, {0.0, -0.006, 1.643}, {0.077, 0.096, 0.104}, 0.02);
    list.ellipsoid(kHead, {0.0, 0.024, 1.600}, {0.063, 0.074, 0.097}, 0.03);
    list.cone(kHead, {0.0, 0.062, 1.538}, {0.0, 0.062, 1.538}, 0.030, 0.030, 0.03);
    list.cone(kHead, {0.0, 0.094, 1.632}, {0.0, 0.108, 1.600}, 0.010, 0.0155, 0.014);
    for (const double side : {1.0, -1.0}) {
        list.ellipsoid(kHead, {side * 0.079, -0.006, 1.612}, {0.013, 0.024, 0.032}, 0.012);
    }
    if (look.beard) list.ellipsoid(kHead, {0.0, 0.066, 1.535}, {0.048, 0.042, 0.050}, 0.03);
    list.ellipsoid(kHead, {0.0, -0.018, 1.654}, {0.085, 0.102, 0.104}, 0.012);
    if (look.hair_style == HairStyle::kLong) {
        list.ellipsoid(kHead, {0.0, -0.075, 1.575}, {0.090, 0.052, 0.150}, 0.03);
    } else if (look.hair_style == HairStyle::kBun) {
        list.ellipsoid(kHead, {0.0, -0.092, 1.728}, {0.046, 0.044, 0.042}, 0.018);
    }
}

// Mirrors a point of the right side for side = -1.
Vector3d on_side(double side, const Vector3d& p) { return {side * p.x(), p.y(), p.z()}; }

void add_arm(PartList& list, double side, double girth) {
    const RestJoints rest;
    const auto bone = [&](Bone right) { return side > 0.0 ? right : left_of(right); };
    const auto at = [&](const Vector3d& p) { return on_side(side, p); };
    const Vector3d thumb = Vector3d::UnitY();
    const Vector3d wrist = rest.wrist();
    // rows: along the fingers, out of the palm, towards the thumb
    Eigen::Matrix3d hand_from_body;
    hand_from_body.row(0) = at(rest.arm_direction);
    hand_from_body.row(1) = at(rest.palm_direction);
    hand_from_body.row(2) = thumb;

    list.cone(
        kChest, at({0.02, -0.004, 1.395}), at({0.150, -0.006, 1.402}), 0.070, 0.060 * girth, 0.035);
    list.cone(
        bone(kUpperArm), at(rest.shoulder), at(rest.elbow()), 0.060 * girth, 0.043 * girth, 0.028);
    list.cone(bone(kForearm), at(rest.elbow()), at(wrist), 0.0435 * girth, 0.0300, 0.015);
    list.ellipsoid(bone(kHand),
                   at(wrist + 0.050 * rest.arm_direction),
                   {0.060, 0.0220, 0.043},
                   0.02,
                   hand_from_body);
    list.ellipsoid(bone(kHand),
                   at(wrist + 0.115 * rest.arm_direction),
                   {0.066, 0.0205, 0.0385},
                   0.015,
                   hand_from_body);
    list.cone(bone(kHand),
              at(wrist + 0.028 * rest.arm_direction + 0.026 * thumb),
              at(wrist + 0.082 * rest.arm_direction + 0.068 * thumb),
              0.0205,
              0.0165,
              0.012);
}

void add_leg(PartList& list, double side, double girth) {
    const RestJoints rest;
    const auto bone = [&](Bone right) { return side > 0.0 ? right : left_of(right); };
    const auto at = [&](const Vector3d& p) { return on_side(side, p); };
    list.cone(bone(kThigh), at(rest.hip), at(rest.knee), 0.086 * girth, 0.059 * girth, 0.022);
    const Vector3d calf = 0.7 * rest.knee + 0.3 * rest.ankle - 0.012 * Vector3d::UnitY();
    list.cone(bone(kShin), at(rest.knee), at(rest.ankle), 0.058 * girth, 0.042 * girth, 0.02);
    list.cone(bone(kShin),
              at(calf),
              at(0.35 * calf + 0.65 * rest.ankle),
              0.056 * girth,
              0.043 * girth,
              0.02);
    list.cone(
        bone(kFoot), at({0.150, -0.045, 0.044}), at({0.162, 0.135, 0.034}), 0.044, 0.036, 0.025);
    list.ellipsoid(bone(kFoot), at({0.161, 0.105, 0.036}), {0.046, 0.085, 0.034}, 0.02);
}

double part_distance(const BodyPart& part, const Vector3d& p) {
    if (part.is_ellipsoid) {
        const Vector3d q = part.part_from_body * (p - part.a);
        const double scaled = q.cwiseQuotient(part.radii_m).norm();
        const double slope = q.cwiseQuotient(part.radii_m.cwiseProduct(part.radii_m)).norm();
        // first-order distance, good near the surface
        return slope > 1e-9 ? scaled * (scaled - 1.0) / slope : -part.radii_m.minCoeff();
    }
    const Vector3d along = part.b - part.a;
    const double length_sq = along.squaredNorm();
    const double t =
        length_sq > 0.0 ? std::clamp((p - part.a).dot(along) / length_sq, 0.0, 1.0) : 0.0;
    return (p - part.a - t * along).norm() -
           (part.radius_a_m + t * (part.radius_b_m - part.radius_a_m));
}

// Quadratic polynomial smooth minimum: solids blend within `blend` of each other.
double smooth_min(double a, double b, double blend) {
    const double h = std::max(blend - std::abs(a - b), 0.0) / blend;
    return std::min(a, b) - 0.25 * h * h * blend;
}

// Bounding sphere of a part and its blending zone; farther away the part is skipped.
struct Reach {
    Vector3d centre;
    double radius_m = 0.0;
};

std::vector<Reach> reaches_of(const std::vector<BodyPart>& parts) {
    constexpr double kMarginM = 0.02;  // the distance to an ellipsoid is approximate
    std::vector<Reach> reaches;
    for (const BodyPart& part : parts) {
        const double radius = std::max({part.radius_a_m, part.radius_b_m, part.radii_m.maxCoeff()});
        reaches.push_back({0.5 * (part.a + part.b),
                           0.5 * (part.b - part.a).norm() + radius + part.blend_m + kMarginM});
    }
    return reaches;
}

double body_distance(const std::vector<BodyPart>& parts,
                     const std::vector<Reach>& reaches,
                     const Vector3d& p) {
    double distance = part_distance(parts.front(), p);
    for (std::size_t i = 1; i < parts.size(); ++i) {
        const double reach = reaches[i].radius_m + distance;
        if (reach < 0.0 || (p - reaches[i].centre).squaredNorm() > reach * reach) continue;
        distance = smooth_min(distance, part_distance(parts[i], p), parts[i].blend_m);
    }
    return distance;
}

geometry::Aabb bounds_of(const std::vector<BodyPart>& parts) {
    geometry::Aabb box;
    for (const BodyPart& part : parts) {
        const double r =
            std::max({part.radius_a_m, part.radius_b_m, part.radii_m.maxCoeff()}) + 3.0 * kCellM;
        for (const Vector3d& p : {part.a, part.b}) {
            box.add(p - Vector3d::Constant(r));
            box.add(p + Vector3d::Constant(r));
        }
    }
    return box;
}

// Weights bones by the distances of their solids; `kSoftnessM` is the width of the joints.
SkinWeights weights_at(const std::vector<BodyPart>& parts, const Vector3d& p) {
    constexpr double kSoftnessM = 0.017;
    std::array<double, kNumBones> distance;
    distance.fill(std::numeric_limits<double>::infinity());
    for (const BodyPart& part : parts)
        distance[part.bone] = std::min(distance[part.bone], part_distance(part, p));
    std::array<std::uint8_t, kNumBones> order{};
    for (std::size_t i = 0; i < kNumBones; ++i) order[i] = static_cast<std::uint8_t>(i);
    std::stable_sort(
        order.begin(), order.end(), [&](auto a, auto b) { return distance[a] < distance[b]; });
    SkinWeights skin;
    double sum = 0.0;
    std::array<double, 4> raw{};
    for (std::size_t i = 0; i < 4; ++i) {
        // the fifth nearest has weight zero: no jump where bones swap places in the order
        const double own = std::exp(-(distance[order[i]] - distance[order[0]]) / kSoftnessM);
        const double fifth = std::exp(-(distance[order[4]] - distance[order[0]]) / kSoftnessM);
        raw[i] = own - fifth;
        sum += raw[i];
    }
    for (std::size_t i = 0; i < 4; ++i) {
        skin.bones[i] = order[i];
        skin.weights[i] = sum > 0.0 ? static_cast<float>(raw[i] / sum) : (i == 0 ? 1.0f : 0.0f);
    }
    return skin;
}

}  // namespace

std::vector<BodyPart> body_parts(const Look& look) {
    PartList list;
    add_trunk(list, look.girth);
    add_head(list, look);
    for (const double side : {1.0, -1.0}) {
        add_arm(list, side, look.girth);
        add_leg(list, side, look.girth);
    }
    return std::move(list.parts);
}

SkinnedBody::SkinnedBody(const Skin& skin, const BoneTransforms& bones)
    : skin_(skin), bones_(bones) {
    for (std::size_t b = 0; b < kNumBones; ++b)
        rotations_[b] = bones[b].rotation.toRotationMatrix();
}

SkinnedVertex SkinnedBody::vertex(std::size_t i) const {
    SkinnedVertex carried{Vector3d::Zero(), Vector3d::Zero()};
    const SkinWeights& weights = skin_.weights[i];
    for (std::size_t k = 0; k < weights.bones.size(); ++k) {
        const double weight = weights.weights[k];
        if (weight == 0.0) continue;
        const std::size_t b = weights.bones[k];
        carried.position +=
            weight * (rotations_[b] * skin_.mesh.vertices[i] + bones_[b].translation);
        carried.normal += weight * (rotations_[b] * skin_.normals[i]);
    }
    return carried;
}

Skin make_skin(const Look& look) {
    const std::vector<BodyPart> parts = body_parts(look);
    const std::vector<Reach> reaches = reaches_of(parts);
    const DistanceField distance = [&parts, &reaches](const Vector3d& p) {
        return body_distance(parts, reaches, p);
    };
    Skin skin;
    skin.mesh = surface_nets(distance, bounds_of(parts), kCellM);
    skin.normals.reserve(skin.mesh.vertices.size());
    skin.weights.reserve(skin.mesh.vertices.size());
    for (Vector3d& vertex : skin.mesh.vertices) {
        skin.normals.push_back(gradient_direction(distance, vertex, 0.25 * kCellM));
        skin.weights.push_back(weights_at(parts, vertex));
        vertex.z() = std::max(vertex.z(), 0.0);  // flat soles
    }
    return skin;
}

}  // namespace atrium::simulation
