#pragma once

#include "core/base/expected.hpp"
#include "core/bus/messages.hpp"
#include "core/codec/mesh_codec.hpp"
#include "world_server/physics/people/person_shape.hpp"

#include <optional>

namespace atrium::world_server {

/// Converts the meshes of one site, in the order of their capture, to shapes for the physics. No
/// network. Not thread-safe.
class SiteReader {
public:
    SiteReader(const geometry::RigidTransform& world_from_site,
               const physics::PersonShapeOptions& options)
        : world_from_site_(world_from_site), shaper_(options) {}

    /// Returns nullopt if the site has no person. Fails with kInvalidData if a mesh cannot be
    /// decoded, reaches further than 15 m from the site's origin, or was captured before the last
    /// one.
    Expected<std::optional<physics::PersonShape>> read(const bus::SiteMesh& message);

private:
    geometry::RigidTransform world_from_site_;
    codec::MeshDecoder decoder_;
    geometry::TriangleMesh mesh_;
    physics::PersonShaper shaper_;
    Timestamp last_capture_;
};

/// True if a mesh was captured before or at the same time as the site's last mesh. False if it is
/// more than a second older: the site was restarted with another clock.
bool is_out_of_order(Timestamp capture, Timestamp last_capture);

}  // namespace atrium::world_server
