#pragma once

#include "core/base/expected.hpp"
#include "core/codec/texture_codec.hpp"
#include "core/config/rig.hpp"
#include "core/geometry/triangle_mesh.hpp"
#include "core/image/raw_image.hpp"

#include <filesystem>
#include <string>
#include <vector>

// What the measurements of the codecs take their meshes and pictures from.
namespace atrium::bench {

/// What one camera saw: all that is needed to cut out the subject again.
struct CodecView {
    geometry::CalibratedCamera camera;
    image::RawImage raw;
    image::YuvImage buffer;
    image::YuvView picture;   // of `raw`; may point into `buffer`
    image::Mask mask;         // as large as the picture; its 2x2 blocks are of one value
    codec::TextureCrop crop;  // as sent, with `mask` halved; the colours of its foreground are
                              // those of the picture
};

/// One instant as the site's pipeline sees it, before it is coded.
struct CodecFrame {
    std::string scene;
    geometry::TriangleMesh mesh;
    std::vector<CodecView> views;
};

/// Some instants of the simulated room, eight cameras of 1 MP with a mosaic and noise.
Expected<std::vector<CodecFrame>> simulated_frames(int num_instants);

/// The instant of a recording of one, by `num_views` of its cameras as evenly spread as they are
/// numbered.
Expected<std::vector<CodecFrame>> recorded_frames(const std::filesystem::path& folder,
                                                  std::size_t num_views);

}  // namespace atrium::bench
