#pragma once

#include "core/base/expected.hpp"
#include "core/geometry/aabb.hpp"

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace atrium::hull_tool {

struct ToolOptions {
    std::filesystem::path views_file;  // or
    std::filesystem::path recording;   // a folder
    int frame = 0;
    std::filesystem::path output;  // empty: no mesh is written
    int threads = 1;
    int repeat = 1;
    std::vector<std::string> without;  // names of views that are left out
    std::optional<geometry::Aabb> bounds;
    bool partial = false;  // what lies outside of the pictures is unknown; needs bounds
    std::uint32_t min_views = 0;
    double min_litres = 0.005;
    bool keep_phantoms = false;
    double decimate_mm = 0.0;  // 0: the mesh is written as it is
    bool normals = false;      // written with the mesh
};

/// How the program goes on after its command line.
struct Start {
    bool go_on = false;
    int exit_code = 0;  // otherwise
};

/// Reads the command line; where the program is to end at once (help, version, an error, which was
/// printed), false and the exit code.
Start parse_command_line(int argc, char** argv, ToolOptions& options);

/// Computes the hull, writes the mesh and returns the report, one JSON object. Lack of memory or
/// threads is an error as well: kInternal.
Expected<std::string> run(const ToolOptions& options);

}  // namespace atrium::hull_tool
