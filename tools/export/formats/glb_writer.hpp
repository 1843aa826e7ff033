#pragma once

#include "tools/export/formats/frame_writer.hpp"

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>

namespace atrium::exporting {

struct GlbOptions {
    std::filesystem::path file;  // NAME.glb; of several files NAME_001.glb, NAME_002.glb, ...
    bool has_draco = true;       // KHR_draco_mesh_compression
    int jpeg_quality = 95;
    /// A further file begins when this one has so many bytes or frames; 0: never.
    std::uint64_t file_bytes = 0;
    std::uint64_t file_frames = 0;
};

/// Writes glTF 2.0: a node per frame, which an animation with steps shows at its time and hides
/// afterwards by its scale, because glTF has no sequences of meshes. Unlit material, JPEG textures.
/// The node of the site turns +Z up into glTF's +Y up. Times count from the first frame of all
/// files, so several files in one scene show one sequence. A camera path is in the first file.
std::unique_ptr<FrameWriter> make_glb_writer(const GlbOptions& options,
                                             const ExportFacts& facts,
                                             const std::optional<CameraPath>& path);

}  // namespace atrium::exporting
