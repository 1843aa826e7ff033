#pragma once

#include "core/base/expected.hpp"
#include "core/config/option_set.hpp"

#include <cstdint>
#include <filesystem>
#include <stop_token>
#include <string>

/// Exports the people of a recording for other programs.
namespace atrium::exporting {

struct ExportConfig {
    std::filesystem::path file;
    std::filesystem::path output;
    std::string site;             // empty: the only one
    std::string format = "auto";  // by the ending of `output`
    std::string frame = "site";
    std::filesystem::path path;  // of a camera
    std::string eye = "normals";
    double from_s = 0.0;
    double to_s = 0.0;  // 0: the end
    std::uint32_t every = 1;
    int quality = 95;
    bool draco = false;  // Debian's Blender reads no Draco
    std::uint32_t chunk_mb = 256;
    std::uint32_t chunk_frames = 0;
    std::uint32_t points = 100'000;
    std::uint32_t threads = 0;  // 0: one per core
};

void declare(ExportConfig& config, config::OptionSet& options);
Expected<void> check(const ExportConfig& config);

/// The format of the export: "glb", "obj", "ply", "points" or "usd". kConfiguration if neither
/// `format` nor the ending of `output` says it, or if they contradict.
Expected<std::string> format_of(const ExportConfig& config);
/// True if the output is the file of a single frame; a sequence of these formats is a folder.
bool is_single_frame(const ExportConfig& config);

/// Exports, on all cores. kInternal if it is stopped before the end: files that are not whole are
/// removed.
Expected<void> run_export(const ExportConfig& config, std::stop_token stop);

}  // namespace atrium::exporting
