#pragma once

#include "core/base/expected.hpp"
#include "core/geometry/aabb.hpp"

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace atrium::hull_tool {

struct ToolOptions {
    std::filesystem::path views_file;  // this or `recording`
    std::filesystem::path recording;   // a folder
    int frame = 0;
    std::filesystem::path config;  // site file with the options of the silhouettes; empty: defaults
    std::filesystem::path output;  // empty: no mesh file
    int threads = 1;
    int repeat = 1;
    std::vector<std::string> without;      // names of views to ignore
    std::optional<geometry::Aabb> bounds;  // empty: those of the rig of a recording, if it has any
    bool no_bounds = false;                // not even those
    bool partial = false;                  // space outside the pictures is unknown; needs bounds
    std::uint32_t min_views = 0;
    double min_litres = 0.005;
    bool keep_phantoms = false;
    double decimate_mm = 0.0;  // 0: the mesh is not decimated
    bool normals = false;      // write them with the mesh
};

/// How the program continues after its command line.
struct Start {
    bool go_on = false;
    int exit_code = 0;  // if not go_on
};

/// Parses the command line. Returns go_on = false and the exit code if the program must end at once
/// (help, version, or an error, already printed).
Start parse_command_line(int argc, char** argv, ToolOptions& options);

/// Computes the hull, writes the mesh and returns the report, one JSON object. Errors kInternal if
/// memory or threads are missing.
/// `warn` receives judgements about the input, one line each; they are in the report as well.
Expected<std::string> run(const ToolOptions& options,
                          const std::function<void(const std::string&)>& warn = {});

}  // namespace atrium::hull_tool
