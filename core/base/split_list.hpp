#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace atrium {

/// The parts of a list such as "alice, bob", without spaces around them and without empty ones.
std::vector<std::string> split_list(std::string_view list, char separator = ',');

}  // namespace atrium
