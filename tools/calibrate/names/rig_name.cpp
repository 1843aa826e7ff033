#include "tools/calibrate/names/rig_name.hpp"

#include "core/config/rig.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <string_view>
#include <utility>
#include <vector>

namespace atrium::calibrate {
namespace {

// Letters with one accent: `letters[i]` is `bases[i]` with `accent`.
struct Accented {
    char32_t accent;
    std::string_view bases;
    std::u32string_view letters;
};
constexpr std::array kAccented{
    Accented{0x300, "AEIOUaeiouNn", U"ÀÈÌÒÙàèìòùǸǹ"},
    Accented{0x301, "AEIOUYaeiouyCcLlNnRrSsZz", U"ÁÉÍÓÚÝáéíóúýĆćĹĺŃńŔŕŚśŹź"},
    Accented{0x302, "AEIOUaeiouCcGgHhJjSsWwYy", U"ÂÊÎÔÛâêîôûĈĉĜĝĤĥĴĵŜŝŴŵŶŷ"},
    Accented{0x303, "ANOanoIiUu", U"ÃÑÕãñõĨĩŨũ"},
    Accented{0x304, "AEIOUaeiou", U"ĀĒĪŌŪāēīōū"},
    Accented{0x306, "AaEeGgIiOoUu", U"ĂăĔĕĞğĬĭŎŏŬŭ"},
    Accented{0x307, "CcEeGgIZz", U"ĊċĖėĠġİŻż"},
    Accented{0x308, "AEIOUYaeiouy", U"ÄËÏÖÜŸäëïöüÿ"},
    Accented{0x30A, "AaUu", U"ÅåŮů"},
    Accented{0x30B, "OoUu", U"ŐőŰű"},
    Accented{0x30C, "CcDdEeLlNnRrSsTtZz", U"ČčĎďĚěĽľŇňŘřŠšŤťŽž"},
    Accented{0x327, "CcGgKkLlNnRrSsTt", U"ÇçĢģĶķĻļŅņŖŗŞşŢţ"},
    Accented{0x328, "AaEeIiUu", U"ĄąĘęĮįŲų"}};

// Letters that are written with two, or that have no accent.
constexpr std::array<std::pair<char32_t, std::string_view>, 23> kSpelled{{
    {U'Ä', "Ae"}, {U'Ö', "Oe"}, {U'Ü', "Ue"}, {U'ä', "ae"}, {U'ö', "oe"}, {U'ü', "ue"},
    {U'ß', "ss"}, {U'Æ', "Ae"}, {U'æ', "ae"}, {U'Œ', "Oe"}, {U'œ', "oe"}, {U'Ø', "Oe"},
    {U'ø', "oe"}, {U'Ł', "L"},  {U'ł', "l"},  {U'Đ', "D"},  {U'đ', "d"},  {U'Ð', "D"},
    {U'ð', "d"},  {U'Þ', "Th"}, {U'þ', "th"}, {U'ı', "i"},  {U'ſ', "s"},
}};

// One character and its bytes. An invalid byte is a character without a code.
struct Character {
    char32_t code = 0;
    std::string bytes;
};

std::vector<Character> characters_of(const std::string& text) {
    std::vector<Character> result;
    for (std::size_t i = 0; i < text.size();) {
        const auto first = static_cast<unsigned char>(text[i]);
        const std::size_t size = first < 0x80             ? 1
                                 : (first & 0xE0) == 0xC0 ? 2
                                 : (first & 0xF0) == 0xE0 ? 3
                                 : (first & 0xF8) == 0xF0 ? 4
                                                          : 0;
        Character character{size < 2 ? first : static_cast<char32_t>(first & (0x7FU >> size)),
                            text.substr(i, std::max<std::size_t>(size, 1))};
        bool is_valid = size > 0 && character.bytes.size() == size;
        for (std::size_t k = 1; is_valid && k < size; ++k) {
            const auto next = static_cast<unsigned char>(text[i + k]);
            is_valid = (next & 0xC0) == 0x80;
            character.code = character.code << 6U | (next & 0x3FU);
        }
        if (!is_valid) character = {0, text.substr(i, 1)};
        i += character.bytes.size();
        result.push_back(std::move(character));
    }
    return result;
}

std::string two_bytes(char32_t code) {
    return {static_cast<char>(0xC0U | code >> 6U), static_cast<char>(0x80U | (code & 0x3FU))};
}

// As letters of a rig's name.
std::string spelled(char32_t code) {
    for (const auto& [letter, text] : kSpelled)
        if (letter == code) return std::string(text);
    for (const Accented& accented : kAccented) {
        const std::size_t at = accented.letters.find(code);
        if (at != std::u32string_view::npos) return {accented.bases[at]};
    }
    return "_";
}

}  // namespace

std::string composed(const std::string& text) {
    std::string result;
    std::size_t last = 0;  // place of the last character
    for (const Character& character : characters_of(text)) {
        const auto* const accented =
            std::ranges::find(kAccented, character.code, &Accented::accent);
        const std::size_t at = accented == kAccented.end() || last + 1 != result.size()
                                   ? std::string_view::npos
                                   : accented->bases.find(result.back());
        if (at != std::string_view::npos) {
            result.resize(last);
            result += two_bytes(accented->letters[at]);
        } else {
            last = result.size();
            result += character.bytes;
        }
    }
    return result;
}

std::string rig_name(const std::string& original) {
    constexpr std::size_t kMaxLetters = 60;
    std::string name;
    for (const Character& character : characters_of(composed(original))) {
        const std::string text =
            config::is_valid_name(character.bytes) ? character.bytes : spelled(character.code);
        if (name.size() + text.size() > kMaxLetters) break;
        name += text;
    }
    const bool is_readable =
        std::ranges::any_of(name, [](unsigned char c) { return std::isalnum(c) != 0; });
    return is_readable || name == original ? name : std::string();
}

}  // namespace atrium::calibrate
