#include "tools/calibrate/recording/name_parts.hpp"

#include "tools/calibrate/formats/rig_name.hpp"

#include <cctype>
#include <filesystem>

namespace atrium::calibrate {

std::string lower(const std::string& text) {
    std::string result = composed(text);
    unsigned char former = 0;
    for (char& raw : result) {
        const auto c = static_cast<unsigned char>(raw);
        // U+00C0 to U+00DE, but not the sign of multiplication
        const bool is_capital = former == 0xC3 && c >= 0x80 && c <= 0x9E && c != 0x97;
        raw = static_cast<char>(is_capital ? c + 0x20 : c < 0x80 ? std::tolower(c) : c);
        former = c;
    }
    return result;
}

bool is_letter(char c) {
    const auto byte = static_cast<unsigned char>(c);
    return byte >= 0x80 || std::isalpha(byte) != 0;
}

std::vector<std::string> tokens(const std::string& text) {
    std::vector<std::string> result;
    char kind = ' ';
    for (const char c : lower(text)) {
        const char here = is_letter(c)                                       ? 'a'
                          : std::isdigit(static_cast<unsigned char>(c)) != 0 ? '1'
                                                                             : ' ';
        if (here != kind && here != ' ') result.emplace_back();
        kind = here;
        if (here == ' ') continue;
        if (here == '1' && result.back() == "0") result.back().clear();
        result.back() += c;
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
