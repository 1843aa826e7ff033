#pragma once

#include "tools/export/formats/frame_writer.hpp"

#include <cstddef>
#include <filesystem>
#include <memory>

namespace atrium::exporting {

struct NumberedOptions {
    std::filesystem::path folder;  // of a sequence; made if it is missing
    std::string stem;              // NAME of the files: NAME_000001.obj
    bool is_single = false;        // one frame: NAME.obj
    int jpeg_quality = 95;         // OBJ
    std::size_t num_points = 0;    // of a point cloud
};

// A file of its own for each frame, with the axes of Atrium. What is written stays when the export
// ends early.

/// NAME.obj with NAME.mtl and NAME.jpg.
std::unique_ptr<FrameWriter> make_obj_writer(const NumberedOptions& options,
                                             const ExportFacts& facts);
/// Binary PLY with a colour per vertex.
std::unique_ptr<FrameWriter> make_ply_writer(const NumberedOptions& options,
                                             const ExportFacts& facts);
/// Binary PLY of points with normals and colours.
std::unique_ptr<FrameWriter> make_points_writer(const NumberedOptions& options,
                                                const ExportFacts& facts);

}  // namespace atrium::exporting
