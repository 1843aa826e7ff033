#include "tools/calibrate/recording/name_parts.hpp"

#include <algorithm>
#include <cctype>
#include <filesystem>

namespace atrium::calibrate {

std::string lower(std::string text) {
    std::ranges::transform(text, text.begin(), [](unsigned char c) { return std::tolower(c); });
    return text;
}

std::vector<std::string> tokens(const std::string& text) {
    std::vector<std::string> result;
    char kind = ' ';
    for (const char raw : text) {
        const auto c = static_cast<unsigned char>(raw);
        const char here = std::isdigit(c) != 0 ? '1' : std::isalpha(c) != 0 ? 'a' : ' ';
        if (here != kind && here != ' ') result.emplace_back();
        kind = here;
        if (here == ' ') continue;
        if (here == '1' && result.back() == "0") result.back().clear();
        result.back() += static_cast<char>(std::tolower(c));
    }
    return result;
}

bool is_number(const std::string& token) {
    return !token.empty() && std::isdigit(static_cast<unsigned char>(token.front())) != 0;
}

std::vector<std::string> parts_of(const std::string& label) {
    std::vector<std::string> parts;
    for (const std::filesystem::path& part : std::filesystem::path(label))
        parts.push_back(part.string());
    return parts;
}

}  // namespace atrium::calibrate
