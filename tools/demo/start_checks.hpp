#pragma once

#include "core/base/expected.hpp"
#include "tools/demo/demo.hpp"

#include <filesystem>
#include <string>
#include <vector>

namespace atrium::demo {

/// A site of the demo.
struct DemoSite {
    std::string name;  // as it announces itself: site.name of its file
    std::filesystem::path file;
    std::string motion;  // empty: from the file
};

/// Completes a configuration that leaves paths as they are by default: `programs`, the folder of
/// the demo's own program, and, where the current folder has no such files, `deploy`, `world` and
/// `viewer` of an installation, which are in `deploy` beside that folder.
void use_installed(DemoConfig& config, const std::filesystem::path& programs);

/// Checks all that the demo needs before it starts anything: the files of sites, world and viewer,
/// and the programs.
Expected<std::vector<DemoSite>> check_start(const DemoConfig& config);

/// Folder of the world's models and textures, which the viewer needs too: world.models of the world
/// file, or the folder of that file. Empty if the viewer's file names one, or a file is not read.
std::filesystem::path models_for_viewer(const DemoConfig& config);

}  // namespace atrium::demo
