#pragma once

#include "core/base/expected.hpp"
#include "core/bus/messages.hpp"
#include "core/codec/mesh_codec.hpp"
#include "core/codec/texture_codec.hpp"
#include "viewer/receive/pairing.hpp"
#include "viewer/renderer/person/person_model.hpp"

#include <Eigen/Core>

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace atrium::viewer {

/// Limits on data from untrusted senders.
struct PersonLimits {
    std::uint32_t max_triangles = 100'000;      // a person has about 10,000
    int max_picture_side_px = 4096;             // side of a texture
    std::size_t max_layer_bytes = 256U << 20U;  // all textures together, decoded
};

struct PersonDecodeScratch {
    codec::MeshDecoder meshes;
    geometry::TriangleMesh mesh;
    codec::TextureDecoder textures;
    codec::DecodedTexture texture;
    std::vector<Eigen::Vector3f> centres;  // camera centres of all textures
    std::vector<renderer::CameraPicture> pictures;
    renderer::PersonModelScratch model;
};

/// Decodes a pair into a person to draw; `out` is reused. Checks the network data: on error
/// kInvalidData the content of `out` is unspecified, but `out` can be reused. `eyes_site` are the
/// eyes that look at the person: only the textures that these eyes need are decoded
/// (renderer::needed_cameras), all if it is empty.
Expected<void> decode_person(const FramePair& pair,
                             const bus::SiteDescription& description,
                             const PersonLimits& limits,
                             std::span<const Eigen::Vector3f> eyes_site,
                             PersonDecodeScratch& scratch,
                             renderer::PersonModel& out);

}  // namespace atrium::viewer
