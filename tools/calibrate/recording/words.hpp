#pragma once

#include "tools/calibrate/names/name_parts.hpp"

#include <fmt/format.h>

#include <string>
#include <vector>

/// Parts of sentences about pictures.
namespace atrium::calibrate {

/// "'cam1', 'cam2'", of at most 12, in natural order.
inline std::string listed(const std::vector<std::string>& unsorted) {
    const std::vector<std::string> names = in_natural_order(unsorted);
    std::string text;
    for (std::size_t i = 0; i < names.size() && i < 12; ++i)
        text += (i == 0 ? "'" : ", '") + names[i] + "'";
    return names.size() > 12 ? text + ", ..." : text;
}

/// "1 picture", "2 pictures".
inline std::string counted(std::size_t number, const char* one) {
    return fmt::format("{} {}{}", number, one, number == 1 ? "" : "s");
}

/// A word of a command line, in quotes if a shell needs them.
std::string quoted(const std::string& word);

}  // namespace atrium::calibrate
