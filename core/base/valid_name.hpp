#pragma once

#include <cstddef>
#include <string_view>

namespace atrium {

inline constexpr std::size_t kMaxNameLength = 63;

/// True for a valid name of a world, member, site or camera: 1..63 characters of [A-Za-z0-9_.-].
bool is_valid_name(std::string_view name);

/// True for a character of names.
bool is_name_character(char c);

}  // namespace atrium
