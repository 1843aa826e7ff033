#pragma once

#include "core/base/expected.hpp"

#include <filesystem>
#include <string>

namespace atrium::hull_tool {

struct ToolOptions {
    std::filesystem::path views_file;  // or
    std::filesystem::path recording;   // a folder
    int frame = 0;
    std::filesystem::path output;  // empty: no mesh is written
    int threads = 1;
    int repeat = 1;
    bool keep_phantoms = false;
    double decimate_mm = 0.0;  // 0: the mesh is written as it is
    bool normals = false;      // written with the mesh
};

/// Reads the command line; where the program is to end at once (help, version, an error, which was
/// printed), false and the exit code.
struct Start {
    bool go_on = false;
    int exit_code = 0;
};
Start parse_command_line(int argc, char** argv, ToolOptions& options);

/// Computes the hull, writes the mesh and returns the report, one JSON object.
Expected<std::string> run(const ToolOptions& options);

}  // namespace atrium::hull_tool
