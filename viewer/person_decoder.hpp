#pragma once

#include "core/base/expected.hpp"
#include "core/bus/messages.hpp"
#include "core/codec/texture_codec.hpp"
#include "viewer/pairing.hpp"
#include "viewer/renderer/person_model.hpp"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace atrium::viewer {

/// What is shown of a stranger at most.
struct PersonLimits {
    std::uint32_t max_triangles = 100'000;      // a person has about 10,000
    int max_picture_side_px = 4096;             // of a texture
    std::size_t max_layer_bytes = 256U << 20U;  // all pictures together, decoded
};

struct PersonDecodeScratch {
    codec::TextureDecoder textures;
    codec::DecodedTexture texture;
    std::vector<renderer::CameraPicture> pictures;
    renderer::PersonModelScratch model;
};

/// Turns the coded bytes of a pair into a person to draw, in place in `out`. What came from the
/// network is checked: on an error (kInvalidData) `out` holds nothing of use, but can be used
/// again.
Expected<void> decode_person(const FramePair& pair,
                             const bus::SiteDescription& description,
                             const PersonLimits& limits,
                             PersonDecodeScratch& scratch,
                             renderer::PersonModel& out);

}  // namespace atrium::viewer
