#pragma once

#include "core/base/expected.hpp"
#include "core/bus/messages.hpp"
#include "core/codec/mesh_codec.hpp"
#include "core/codec/texture_codec.hpp"
#include "viewer/pairing.hpp"
#include "viewer/renderer/person_model.hpp"

#include <Eigen/Core>

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace atrium::viewer {

/// What is shown of a stranger at most.
struct PersonLimits {
    std::uint32_t max_triangles = 100'000;      // a person has about 10,000
    int max_picture_side_px = 4096;             // of a texture
    std::size_t max_layer_bytes = 256U << 20U;  // all pictures together, decoded
};

struct PersonDecodeScratch {
    codec::MeshDecoder meshes;
    geometry::TriangleMesh mesh;
    codec::TextureDecoder textures;
    codec::DecodedTexture texture;
    std::vector<Eigen::Vector3f> centres;  // of the cameras of all textures
    std::vector<renderer::CameraPicture> pictures;
    renderer::PersonModelScratch model;
};

/// Turns the coded bytes of a pair into a person to draw, in place in `out`. What came from the
/// network is checked: on an error (kInvalidData) `out` holds nothing of use, but can be used
/// again. `eyes_site`: from where she is looked at; only the pictures that such eyes need
/// (renderer::needed_cameras) are decoded, without eyes all.
Expected<void> decode_person(const FramePair& pair,
                             const bus::SiteDescription& description,
                             const PersonLimits& limits,
                             std::span<const Eigen::Vector3f> eyes_site,
                             PersonDecodeScratch& scratch,
                             renderer::PersonModel& out);

}  // namespace atrium::viewer
