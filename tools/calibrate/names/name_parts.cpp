#include "tools/calibrate/names/name_parts.hpp"

#include "tools/calibrate/names/rig_name.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <filesystem>
#include <set>
#include <string_view>

namespace atrium::calibrate {
namespace {

constexpr std::string_view kBetweenWords = "_-. ";

// Without `word` and what divides it from the rest, or the whole name.
std::string without_ending(const std::string& name, std::string_view word) {
    if (!lower(name).ends_with(word) || name.size() == word.size()) return name;
    const std::size_t end = name.size() - word.size();
    const std::size_t last = name.find_last_not_of(kBetweenWords, end - 1);
    return last == std::string::npos || last + 1 == end ? name : name.substr(0, last + 1);
}

std::string without_beginning(const std::string& name, std::string_view word) {
    if (!lower(name).starts_with(word)) return name;
    const std::size_t first = name.find_first_not_of(kBetweenWords, word.size());
    return first == std::string::npos || first == word.size() ? name : name.substr(first);
}

}  // namespace

std::vector<std::string> without_calibration_words(const std::vector<std::string>& names) {
    constexpr std::array<std::string_view, 12> kWords{"calibration",
                                                      "calibrated",
                                                      "calib",
                                                      "cal",
                                                      "intrinsics",
                                                      "intrinsic",
                                                      "intri",
                                                      "extrinsics",
                                                      "parameters",
                                                      "params",
                                                      "camera",
                                                      "cam"};
    if (names.size() < 2) return names;
    std::vector<std::string> result = names;
    const auto drop = [&](const auto& without, std::string_view word) {
        std::vector<std::string> shorter;
        std::set<std::string> different;
        for (const std::string& name : result) {
            shorter.push_back(without(name, word));
            different.insert(shorter.back());
            if (shorter.back() == name || std::ranges::none_of(shorter.back(), is_letter))
                return false;
        }
        if (different.size() < shorter.size()) return false;
        result = std::move(shorter);
        return true;
    };
    for (bool is_changed = true; is_changed;) {
        is_changed = false;
        for (const std::string_view word : kWords) {
            // "cam_left" may be the name of a camera
            const bool may_begin = !word.starts_with("cam");
            is_changed = drop(without_ending, word) ||
                         (may_begin && drop(without_beginning, word)) || is_changed;
        }
    }
    return result;
}

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

bool is_separator(char c) {
    return !is_letter(c) && std::isdigit(static_cast<unsigned char>(c)) == 0;
}

std::string without_separators_behind(std::string name) {
    while (!name.empty() && is_separator(name.back())) name.pop_back();
    return name;
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

std::vector<std::string> telling_tokens(const std::string& label,
                                        const std::vector<std::string>& others) {
    std::vector<std::string> own = tokens(label);
    std::size_t front = own.size();
    std::size_t back = own.size();
    bool is_only = true;
    for (const std::string& other : others) {
        if (other == label) continue;
        is_only = false;
        const std::vector<std::string> theirs = tokens(other);
        std::size_t same = 0;
        while (same < std::min(own.size(), theirs.size()) && own[same] == theirs[same]) ++same;
        front = std::min(front, same);
        same = 0;
        while (same < std::min(own.size(), theirs.size()) &&
               own[own.size() - 1 - same] == theirs[theirs.size() - 1 - same])
            ++same;
        back = std::min(back, same);
    }
    if (is_only || front + back >= own.size()) return own;
    return {own.begin() + static_cast<std::ptrdiff_t>(front),
            own.end() - static_cast<std::ptrdiff_t>(back)};
}

std::string last_number(const std::vector<std::string>& name) {
    const auto number = std::find_if(name.rbegin(), name.rend(), is_number);
    return number == name.rend() ? std::string() : *number;
}

std::vector<std::string> in_natural_order(std::vector<std::string> names) {
    // a shorter number is a smaller one: tokens have no leading zeros
    const auto is_before = [](const std::string& a, const std::string& b) {
        return is_number(a) && is_number(b) && a.size() != b.size() ? a.size() < b.size() : a < b;
    };
    std::ranges::sort(names, [&](const std::string& a, const std::string& b) {
        const std::vector<std::string> words_a = tokens(a);
        const std::vector<std::string> words_b = tokens(b);
        if (words_a == words_b) return a < b;
        return std::ranges::lexicographical_compare(words_a, words_b, is_before);
    });
    return names;
}

}  // namespace atrium::calibrate
