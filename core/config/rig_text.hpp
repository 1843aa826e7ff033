#pragma once

#include "core/config/rig.hpp"

#include <string>
#include <vector>

namespace atrium::config {

/// The text of a rig.toml (docs/conventions.md#recordings). `comments` become lines at its top.
/// Numbers are written so that reading them gives the same bits. Bounds are left out if empty.
std::string rig_text(const Rig& rig, const std::vector<std::string>& comments);

}  // namespace atrium::config
