#pragma once

#include <Eigen/Core>
#include <LinearMath/btVector3.h>

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

class btSoftBody;

namespace atrium::physics {

/// A point of a soft body: a node, the centre of a face, or any other weighted mean of three nodes.
struct SoftSample {
    std::uint32_t nodes[3];
    btScalar weights[3];  // add up to 1
};

/// Motion and inverse effective mass of a point.
struct SampleMotion {
    btVector3 position;     // [m] world
    btVector3 velocity;     // [m/s]
    btScalar inverse_mass;  // inverse effective mass; 0: fixed
};

/// The surface of a soft body for contact detection.
struct SoftSkin {
    std::span<const SoftSample> samples{};
    /// Volumes only, per node: outward unit normal of the rest shape. A surface that faces the same
    /// way has come up inside the volume. It makes no contact, else the skin would hook on to it.
    std::span<const btVector3> outward{};
    btScalar depth_m = 0;  // volumes only: how far their inside reaches behind the skin
    /// Volumes only: the line from the middle to any sample is inside.
    bool is_star_shaped = false;
    // per node; not 0: stretched too far for people to hold it
    std::span<const std::uint8_t> loose{};
    /// The soft body is slow, and no viewer pulls at it. The bodies that it touches may sleep, and
    /// sleeping ones yield to it as little as fixed ones. Otherwise it wakes them.
    bool is_calm = false;
};

/// Outward normal of the rest shape at sample `i`, not normalised. Empty if the soft body is not a
/// volume.
std::optional<btVector3> outward_at(const SoftSkin& skin, std::size_t i);

SampleMotion motion_of(const btSoftBody& soft, const SoftSample& sample);

/// Moves the nodes of the sample as `impulse` [kg m] at that point would.
void move(btSoftBody& soft, const SoftSample& sample, const btVector3& impulse);

/// Returns the mean of all nodes [m].
Eigen::Vector3d centre_of(const btSoftBody& soft);

}  // namespace atrium::physics
