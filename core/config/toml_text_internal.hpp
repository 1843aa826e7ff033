#pragma once

#include "core/base/expected.hpp"

#include <toml.hpp>

#include <string>

namespace atrium::config {

/// Parses TOML text. `name` stands for the file in errors (kConfiguration), which name the line and
/// show it. Private to core/config.
Expected<toml::value> parse_toml(const std::string& text, const std::string& name);

/// Returns a value on one line, for messages: at most 60 characters.
std::string shown(const toml::value& value);

}  // namespace atrium::config
