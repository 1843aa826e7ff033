#pragma once

#include <cstddef>
#include <string_view>

namespace atrium::config {

/// Maximum nesting of tables and arrays, and number of parts of a dotted key. Atrium's files have
/// only a few levels.
inline constexpr std::size_t kMaxTomlNesting = 32;

/// Returns the line, from 1, in which a TOML text exceeds kMaxTomlNesting; 0 if none does. The TOML
/// library recurses once per level, and deep nesting would exhaust the stack. The text need not be
/// valid TOML.
std::size_t line_nested_too_deeply(std::string_view toml);

}  // namespace atrium::config
