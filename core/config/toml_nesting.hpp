#pragma once

#include <cstddef>
#include <string_view>

namespace atrium::config {

/// Tables and lists within each other, and parts of a dotted key. No file of Atrium has more than a
/// few.
inline constexpr std::size_t kMaxTomlNesting = 32;

/// The line, from 1, in which a TOML text goes deeper than that; 0: in none. The library that reads
/// TOML calls itself once per level, and enough of them exhaust the stack. The text need not be
/// TOML.
std::size_t line_nested_too_deeply(std::string_view toml);

}  // namespace atrium::config
