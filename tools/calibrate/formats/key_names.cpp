#include "tools/calibrate/formats/key_names.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>

namespace atrium::calibrate {
namespace {

std::string lower(std::string text) {
    std::ranges::transform(text, text.begin(), [](unsigned char c) { return std::tolower(c); });
    return text;
}

bool is_among(const std::string& key, std::initializer_list<Keys> all) {
    return std::ranges::any_of(all, [&](const Keys keys) {
        return std::ranges::any_of(keys,
                                   [&](const char* name) { return lower(key) == lower(name); });
    });
}

// At the top of a file a camera's name may follow: K_01.
bool is_one_of(const std::string& key, std::initializer_list<Keys> all, int depth) {
    const auto starts_key = [&](const char* known) {
        return key.starts_with(std::string(known) + "_");
    };
    return is_among(key, all) || (depth == 0 && std::ranges::any_of(all, [&](const Keys keys) {
                                      return std::ranges::any_of(keys, starts_key);
                                  }));
}

bool is_key_of_numbers(const std::string& key, int depth) {
    return is_one_of(key,
                     {kMatrix,
                      kFocal[0],
                      kFocal[1],
                      kFocal[2],
                      kFocal[3],
                      kDistortion,
                      kCoefficients,
                      kRotation,
                      kRotationCw,
                      kRotationWc,
                      kTranslation,
                      kTranslationCw,
                      kTranslationWc,
                      kPose,
                      kWidth,
                      kHeight,
                      kSize},
                     depth);
}

bool is_known_key(const std::string& key, int depth) {
    return is_key_of_numbers(key, depth) || is_one_of(key, {kName, kModel}, depth);
}

// The first text in a list, or lists of those, of numbers.
std::string text_among_numbers(const Tree& value, int depth) {
    if (depth > 3 || !value.is_array()) return {};
    for (const Tree& element : value) {
        if (element.is_string()) return element.get<std::string>();
        if (std::string text = text_among_numbers(element, depth + 1); !text.empty()) return text;
    }
    return {};
}

std::string unreadable_below(const Tree& tree, const std::string& path, int depth) {
    if (depth > 4 || !tree.is_structured()) return {};
    for (const auto& [key, value] : tree.items()) {
        const std::string where = path + (path.empty() ? "" : ".") + key;
        if (tree.is_object() && is_key_of_numbers(key, depth)) {
            const std::string comma =
                value.is_string() ? decimal_comma(value.get<std::string>()) : std::string();
            const std::string text = comma.empty() ? text_among_numbers(value, 0) : comma;
            if (!decimal_comma(text).empty()) return where + ": " + comma_is_no_point(text);
            if (!text.empty())
                return fmt::format("{}: '{}' is not a number; write numbers without quotes",
                                   where,
                                   text.substr(0, 40));
        }
        if (std::string bad = unreadable_below(value, where, depth + 1); !bad.empty()) return bad;
    }
    return {};
}

void add_unknown_below(const Tree& tree,
                       int depth,
                       const std::set<std::string>& words,
                       std::vector<std::string>& unknown) {
    constexpr std::size_t kMaxNamed = 12;
    if (depth > 3 || !tree.is_structured()) return;
    for (const auto& [key, value] : tree.items()) {
        if (unknown.size() == kMaxNamed) return;
        const bool has_word = std::ranges::any_of(
            words, [&](const std::string& word) { return !is_key(key) && key.ends_with(word); });
        const bool is_unknown =
            tree.is_object() && numbers(value) && (has_word || !is_known_key(key, depth));
        if (is_unknown && std::ranges::find(unknown, key) == unknown.end()) unknown.push_back(key);
        if (!numbers(value)) add_unknown_below(value, depth + 1, words, unknown);
    }
}

}  // namespace

bool is_key(const std::string& key) {
    return is_among(key,
                    {kMatrix,
                     kDistortion,
                     kRotation,
                     kRotationCw,
                     kRotationWc,
                     kTranslation,
                     kTranslationCw,
                     kTranslationWc,
                     kPose});
}

std::string unreadable_value(const Tree& tree) { return unreadable_below(tree, "", 0); }

void add_unknown_keys(const Tree& tree,
                      const std::set<std::string>& words,
                      std::vector<std::string>& unknown) {
    add_unknown_below(tree, 0, words, unknown);
}

}  // namespace atrium::calibrate
