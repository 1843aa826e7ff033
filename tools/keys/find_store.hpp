#pragma once

#include "core/base/expected.hpp"

#include <filesystem>

namespace atrium::keys_tool {

/// The folder of the key store: `given`, or else the only folder *.keys in `folder`. Fails with
/// kNotFound if there is none, with kConfiguration if there are several.
Expected<std::filesystem::path> find_store(const std::filesystem::path& given,
                                           const std::filesystem::path& folder = ".");

}  // namespace atrium::keys_tool
