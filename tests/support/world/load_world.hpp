#pragma once

#include "core/base/expected.hpp"
#include "world_server/config.hpp"

#include <filesystem>

namespace atrium::test_support {

/// Reads a world file as world_server does, with all its checks, but without a command line.
Expected<world_server::WorldServerConfig> load_world(const std::filesystem::path& file);

}  // namespace atrium::test_support
