#pragma once

#include "core/base/expected.hpp"
#include "core/bus/messages.hpp"
#include "core/codec/mesh_codec.hpp"
#include "world_server/physics/person_shape.hpp"

#include <optional>

namespace atrium::world_server {

/// Turns the meshes of one site, in the order of their capture, into what they are to the physics.
/// Not thread-safe; no network.
class SiteReader {
public:
    SiteReader(const geometry::RigidTransform& world_from_site,
               const physics::PersonShapeOptions& options)
        : world_from_site_(world_from_site), shaper_(options) {}

    /// Nobody is in the site: nullopt. Fails with kInvalidData on a mesh that cannot be decoded,
    /// reaches further than 15 m from the site's origin, or was captured before the last one.
    Expected<std::optional<physics::PersonShape>> read(const bus::SiteMesh& message);

private:
    geometry::RigidTransform world_from_site_;
    codec::MeshDecoder decoder_;
    geometry::TriangleMesh mesh_;
    physics::PersonShaper shaper_;
    Timestamp last_capture_;
};

/// Whether a mesh was captured before, or together with, another one of its site. By more than a
/// second it was not: the site was started again with another clock.
bool is_out_of_order(Timestamp capture, Timestamp last_capture);

}  // namespace atrium::world_server
