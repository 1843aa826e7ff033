#pragma once

#include "tools/export/formats/frame_writer.hpp"

#include <filesystem>
#include <memory>

namespace atrium::exporting {

struct UsdOptions {
    std::filesystem::path file;  // NAME.usda; its pictures are in NAME_textures beside it
    int jpeg_quality = 95;
    double end_s = 0.0;  // time of the last frame
};

/// Writes USD as text: a prim per frame with its own mesh and picture, visible from its time to
/// that of the next one, because the topology changes with each frame and renderers do not animate
/// the file of a texture. Time codes count periods of the rate. UsdPreviewSurface with the texture
/// as its diffuse colour, because some programs read no other texture; it has the room's light in
/// it.
std::unique_ptr<FrameWriter> make_usd_writer(const UsdOptions& options, const ExportFacts& facts);

}  // namespace atrium::exporting
