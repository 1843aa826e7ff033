#pragma once

#include "core/base/expected.hpp"
#include "core/config/rig.hpp"

#include <filesystem>

namespace atrium::capture {

/// The cameras of a recording that has no rig.toml, because they are not calibrated: names of the
/// folders in `folder` that hold `frames.*`, in alphabetical order, and sizes of their first
/// pictures. Focal lengths are a guess, and poses are missing. Errors kConfiguration and kNotFound
/// name the folder.
Expected<config::Rig> rig_of_pictures(const std::filesystem::path& folder);

}  // namespace atrium::capture
