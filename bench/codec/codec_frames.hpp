#pragma once

#include "core/base/expected.hpp"
#include "core/codec/texture_codec.hpp"
#include "core/config/rig.hpp"
#include "core/geometry/triangle_mesh.hpp"
#include "core/image/raw_image.hpp"

#include <filesystem>
#include <string>
#include <vector>

// Meshes and pictures for the benchmarks of the codecs.
namespace atrium::bench {

/// The picture of one camera, with everything needed to crop the subject again.
struct CodecView {
    geometry::CalibratedCamera camera;
    image::RawImage raw;
    image::YuvImage buffer;
    image::YuvView picture;   // of `raw`; may point into `buffer`
    image::Mask mask;         // as large as the picture; constant in each 2x2 block
    codec::TextureCrop crop;  // as sent, with `mask` halved; its foreground has the colours
                              // of the picture
};

/// One instant in the site's pipeline before coding.
struct CodecFrame {
    std::string scene;
    geometry::TriangleMesh mesh;
    std::vector<CodecView> views;
};

/// Some instants of the simulated room, from eight cameras of 1 MP with a mosaic and noise.
Expected<std::vector<CodecFrame>> simulated_frames(int num_instants);

/// The instant of a recording with one instant, from `num_views` of its cameras, evenly spread by
/// number.
Expected<std::vector<CodecFrame>> recorded_frames(const std::filesystem::path& folder,
                                                  std::size_t num_views);

}  // namespace atrium::bench
