#include "core/base/split_list.hpp"

#include <sstream>

namespace atrium {

std::vector<std::string> split_list(std::string_view list, char separator) {
    std::vector<std::string> parts;
    std::istringstream stream{std::string(list)};
    for (std::string part; std::getline(stream, part, separator);) {
        const auto begin = part.find_first_not_of(' ');
        if (begin == std::string::npos) continue;
        parts.push_back(part.substr(begin, part.find_last_not_of(' ') - begin + 1));
    }
    return parts;
}

}  // namespace atrium
