#pragma once

#include "core/geometry/aabb.hpp"
#include "core/geometry/triangle_mesh.hpp"
#include "simulation/look.hpp"
#include "simulation/skeleton.hpp"

#include <array>
#include <cstdint>
#include <vector>

namespace atrium::simulation {

/// One solid of the body, which blends into the others: a cone with round ends, or an ellipsoid
/// with centre `a`.
struct BodyPart {
    Bone bone = kPelvis;
    Eigen::Vector3d a, b;
    double radius_a_m = 0.0;
    double radius_b_m = 0.0;
    bool is_ellipsoid = false;
    Eigen::Vector3d radii_m;
    Eigen::Matrix3d part_from_body;  // axes of the ellipsoid, as rows
    double blend_m = 0.03;           // blending distance to the preceding parts
};

/// Returns the rest body of a look, in the body frame of nominal height.
std::vector<BodyPart> body_parts(const Look& look);

/// Up to four bones that move a vertex. Weights are not negative and sum to one.
struct SkinWeights {
    std::array<std::uint8_t, 4> bones{};
    std::array<float, 4> weights{};
};

/// The skin in its rest pose: one closed 2-manifold mesh.
struct Skin {
    geometry::TriangleMesh mesh;
    std::vector<Eigen::Vector3d> normals;
    std::vector<SkinWeights> weights;
};

/// One vertex after linear blend skinning, in the body frame.
struct SkinnedVertex {
    Eigen::Vector3d position;
    Eigen::Vector3d normal;  // not of unit length
};

/// A skin in a posture. `skin` must outlive it.
class SkinnedBody {
public:
    SkinnedBody(const Skin& skin, const BoneTransforms& bones);
    SkinnedVertex vertex(std::size_t i) const;

private:
    const Skin& skin_;
    BoneTransforms bones_;
    std::array<Eigen::Matrix3d, kNumBones> rotations_;
};

/// Builds a skin of about 16 000 triangles; takes about a tenth of a second.
Skin make_skin(const Look& look);

}  // namespace atrium::simulation
