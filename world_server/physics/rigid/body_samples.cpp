#include "world_server/physics/rigid/body_samples.hpp"

#include "world_server/physics/rigid/bullet_types.hpp"

#include <btBulletCollisionCommon.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace atrium::physics {
namespace {

constexpr float kInsetM = 0.0005F;  // rays exactly along an edge would miss the shape

// Casts rays at a shape and records the hit points with their normals.
struct Caster {
    Caster(const btCollisionShape& collision_shape, float least_facing)
        : shape(collision_shape), min_facing(least_facing) {
        object.setCollisionShape(const_cast<btCollisionShape*>(&shape));
        object.setWorldTransform(btTransform::getIdentity());
    }
    void cast(const btVector3& from, const btVector3& to, std::vector<BodySample>& samples) {
        btCollisionWorld::ClosestRayResultCallback result(from, to);
        btCollisionWorld::rayTestSingle(btTransform(btQuaternion::getIdentity(), from),
                                        btTransform(btQuaternion::getIdentity(), to),
                                        &object,
                                        &shape,
                                        btTransform::getIdentity(),
                                        result);
        if (!result.hasHit()) return;
        const btVector3 back = (from - to).normalized();
        if (result.m_hitNormalWorld.dot(back) < min_facing) return;
        samples.push_back({floats_from_bullet(result.m_hitPointWorld),
                           floats_from_bullet(result.m_hitNormalWorld).normalized()});
    }
    const btCollisionShape& shape;
    float min_facing;
    btCollisionObject object;
};

void cast_lattice(const btCollisionShape& shape,
                  const Eigen::Vector3f& low,
                  const Eigen::Vector3f& high,
                  double spacing_m,
                  float min_facing,
                  std::vector<BodySample>& samples) {
    Caster caster(shape, min_facing);
    const Eigen::Vector3f size = high - low;
    const auto num_along = [&](int axis) {
        return 1 + static_cast<int>(std::ceil((size[axis] - 2.0F * kInsetM) / spacing_m));
    };
    for (int axis = 0; axis < 3; ++axis) {
        const int u = (axis + 1) % 3;
        const int v = (axis + 2) % 3;
        const int num_u = std::max(2, num_along(u));
        const int num_v = std::max(2, num_along(v));
        for (int i = 0; i < num_u * num_v; ++i) {
            const float share_u = static_cast<float>(i % num_u) / static_cast<float>(num_u - 1);
            const float share_v = static_cast<float>(i / num_u) / static_cast<float>(num_v - 1);
            Eigen::Vector3f from;
            from[u] = low[u] + kInsetM + share_u * (size[u] - 2.0F * kInsetM);
            from[v] = low[v] + kInsetM + share_v * (size[v] - 2.0F * kInsetM);
            from[axis] = low[axis] - 0.1F;
            Eigen::Vector3f to = from;
            to[axis] = high[axis] + 0.1F;
            caster.cast(to_bullet(from), to_bullet(to), samples);
            caster.cast(to_bullet(to), to_bullet(from), samples);
        }
    }
}

// Adds the extreme point `tip` of `direction`. `tips` holds the tips found before.
void add_tip(const Eigen::Vector3f& tip,
             const Eigen::Vector3f& direction,
             const std::vector<BodySample>& samples,
             float same_point_m,
             std::vector<BodySample>& tips) {
    const auto is_there = [&](const BodySample& other) {
        return (other.point - tip).squaredNorm() < same_point_m * same_point_m;
    };
    if (std::any_of(samples.begin(), samples.end(), is_there)) return;
    const auto known = std::find_if(tips.begin(), tips.end(), is_there);
    if (known == tips.end()) {
        tips.push_back({tip, direction});
    } else {
        known->outwards += direction;
    }
}

void add_tips(const btCollisionShape& shape,
              const btTransform& place,
              const std::vector<BodySample>& samples,
              const BodySamplingOptions& options,
              std::vector<BodySample>& tips) {
    if (shape.isCompound()) {
        const auto& compound = static_cast<const btCompoundShape&>(shape);
        for (int i = 0; i < compound.getNumChildShapes(); ++i) {
            const btTransform child = place * compound.getChildTransform(i);
            add_tips(*compound.getChildShape(i), child, samples, options, tips);
        }
        return;
    }
    if (!shape.isConvex()) return;
    const auto& convex = static_cast<const btConvexShape&>(shape);
    for (const Eigen::Vector3f& direction : even_directions(options.num_tips)) {
        const btVector3 tip = place * convex.localGetSupportingVertex(to_bullet(direction));
        const btVector3 outwards = place.getBasis() * to_bullet(direction);
        add_tip(floats_from_bullet(tip),
                floats_from_bullet(outwards),
                samples,
                options.same_point_m,
                tips);
    }
}

}  // namespace

std::vector<Eigen::Vector3f> even_directions(std::size_t num) {
    std::vector<Eigen::Vector3f> directions;
    directions.reserve(num);
    const double turn = std::numbers::pi * (3.0 - std::sqrt(5.0));  // golden angle
    for (std::size_t i = 0; i < num; ++i) {
        const double z = 1.0 - (2.0 * static_cast<double>(i) + 1.0) / static_cast<double>(num);
        const double radius = std::sqrt(std::max(0.0, 1.0 - z * z));
        const double angle = turn * static_cast<double>(i);
        directions.push_back(
            Eigen::Vector3d(radius * std::cos(angle), radius * std::sin(angle), z).cast<float>());
    }
    return directions;
}

std::vector<BodySample> sample_body(const btCollisionShape& shape,
                                    const BodySamplingOptions& options) {
    btVector3 low;
    btVector3 high;
    shape.getAabb(btTransform::getIdentity(), low, high);
    const Eigen::Vector3f size = floats_from_bullet(high) - floats_from_bullet(low);
    const double box_m2 = 2.0 * (size.x() * size.y() + size.y() * size.z() + size.z() * size.x());
    const double spacing_m =
        std::max(options.spacing_m, std::sqrt(box_m2 / static_cast<double>(options.max_samples)));
    std::vector<BodySample> samples;
    cast_lattice(shape,
                 floats_from_bullet(low),
                 floats_from_bullet(high),
                 spacing_m,
                 options.min_facing,
                 samples);
    std::vector<BodySample> tips;
    add_tips(shape, btTransform::getIdentity(), samples, options, tips);
    for (BodySample& tip : tips) {
        tip.outwards.normalize();
        samples.push_back(tip);
    }
    return samples;
}

}  // namespace atrium::physics
