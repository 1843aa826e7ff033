#include "core/config/toml_nesting.hpp"
#include "core/config/toml_text_internal.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <sstream>
#include <string_view>
#include <vector>

namespace atrium::config {
namespace {

// True for text with characters that no text editor writes: UTF-16, pictures, programs.
bool is_binary(std::string_view text) {
    return text.find('\0') != std::string_view::npos || text.starts_with("\xFF\xFE") ||
           text.starts_with("\xFE\xFF");
}

// Line of the first byte that is not UTF-8, from 1; 0 if there is none. As strict as the library,
// which reads beyond its memory if a literal string of several lines has a longer form than needed
// or a surrogate (toml11 3.7.1).
std::size_t line_not_utf8(std::string_view text) {
    std::size_t line = 1;
    for (std::size_t i = 0; i < text.size(); ++i) {
        const auto byte = static_cast<unsigned char>(text[i]);
        if (byte == '\n') ++line;
        if (byte < 0x80) continue;
        const int num_more = byte >= 0xF0 && byte < 0xF5   ? 3
                             : byte >= 0xE0 && byte < 0xF0 ? 2
                             : byte >= 0xC2 && byte < 0xE0 ? 1
                                                           : 0;
        if (num_more == 0) return line;
        // the first of the others says whether the form is a shortest one of a letter
        unsigned min = byte == 0xE0 ? 0xA0 : byte == 0xF0 ? 0x90 : 0x80;
        unsigned max = byte == 0xED ? 0x9F : byte == 0xF4 ? 0x8F : 0xBF;
        for (int k = 0; k < num_more; ++k) {
            if (++i >= text.size()) return line;
            const auto next = static_cast<unsigned char>(text[i]);
            if (next < min || next > max) return line;
            min = 0x80;
            max = 0xBF;
        }
    }
    return 0;
}

// The line of that number, from 1, without spaces around it and at most 60 characters long.
std::string line_of(std::string_view text, std::size_t number) {
    constexpr std::size_t kMaxLength = 60;
    for (; number > 1; --number) {
        const auto end = text.find('\n');
        if (end == std::string_view::npos) return {};
        text.remove_prefix(end + 1);
    }
    text = text.substr(0, text.find_first_of("\r\n"));
    text.remove_prefix(std::min(text.find_first_not_of(" \t"), text.size()));
    std::string line;
    for (const char c : text.substr(0, kMaxLength))
        line += static_cast<unsigned char>(c) < ' ' ? '?' : c;
    return line;
}

bool is_digit(char c) { return c >= '0' && c <= '9'; }

// Of a number that starts or ends with its decimal point, as ".5" or "5.", how TOML writes it; or
// nothing.
std::string number_meant_in(std::string_view line) {
    char quote = 0;
    for (std::size_t i = 0; i < line.size(); ++i) {
        const char c = line[i];
        if (quote != 0) {
            if (c == quote) quote = 0;
        } else if (c == '"' || c == '\'') {
            quote = c;
        } else if (c == '#') {
            return {};
        } else if (c == '.') {
            std::size_t begin = i, end = i + 1;
            while (begin > 0 && is_digit(line[begin - 1])) --begin;
            while (end < line.size() && is_digit(line[end])) ++end;
            const std::string_view before = line.substr(begin, i - begin);
            const std::string_view after = line.substr(i + 1, end - i - 1);
            if (before.empty() == after.empty()) continue;
            return fmt::format("{}.{}", before.empty() ? "0" : before, after.empty() ? "0" : after);
        }
    }
    return {};
}

// What is probably wrong with the line of the text, of which the library says `what`.
std::string hint(std::string_view text, std::string_view line, std::string_view what) {
    if (text.find('\n') == text.npos && text.find('\r') != text.npos)
        return "its lines end with a carriage return alone: save it with Unix or Windows line ends";
    const auto equals = line.find('=');
    if (line.find("\xE2\x80\x9C") != line.npos || line.find("\xE2\x80\x9D") != line.npos)
        return "text needs straight double quotes, not typographic ones";
    if (what.find("already exists") == what.npos && equals != line.npos &&
        line.find('\\', equals) != line.npos)
        return "a backslash starts an escape in double quotes: write / in paths";
    if (line.starts_with('[')) return "a table is written [name], several of them [[name]]";
    if (what.ends_with("already exists")) return "write each key once in its table";
    if (const std::string number = number_meant_in(line); !number.empty())
        return fmt::format("a number needs digits on both sides of its point: write {}", number);
    if (equals == std::string_view::npos) return "a value is written key = value";
    return "text needs double quotes, a number a decimal point, and a switch is true or false";
}

// The library's text without its own name and its picture of the place.
std::string what_of(const std::exception& failure) {
    std::string what = failure.what();
    what = what.substr(0, what.find('\n'));
    for (const std::string_view mark : {"[error] ", "toml::"}) {
        if (!what.starts_with(mark)) continue;
        what = what.substr(mark.size());
        if (mark == "toml::") what = what.substr(std::min(what.find(": ") + 2, what.size()));
    }
    while (what.ends_with('.')) what.pop_back();
    return what;
}

// On one line, however it is written in the file.
std::string one_line(const toml::value& value) {
    if (value.is_array()) {
        std::vector<std::string> items;
        for (const toml::value& item : value.as_array()) items.push_back(one_line(item));
        return fmt::format("[{}]", fmt::join(items, ", "));
    }
    // the library writes 17 digits
    if (value.is_floating()) {
        const std::string number = fmt::format("{}", value.as_floating());
        return number.find_first_of(".en") == std::string::npos ? number + ".0" : number;
    }
    std::ostringstream text;
    text << toml::format(value, 0);
    std::string line = text.str();
    std::replace(line.begin(), line.end(), '\n', ' ');
    return line;
}

}  // namespace

Expected<toml::value> parse_toml(const std::string& text, const std::string& name) {
    if (is_binary(text)) {
        return make_error(ErrorKind::kConfiguration,
                          fmt::format("{}: is not a text file in UTF-8; is it the right file? An "
                                      "editor may have saved it as UTF-16",
                                      name));
    }
    if (const std::size_t line = line_not_utf8(text); line != 0) {
        return make_error(ErrorKind::kConfiguration,
                          fmt::format("{}:{}: a letter is not in UTF-8, but perhaps in Latin-1; "
                                      "save the file as UTF-8",
                                      name,
                                      line));
    }
    if (const std::size_t line = line_nested_too_deeply(text); line != 0) {
        return make_error(
            ErrorKind::kConfiguration,
            fmt::format("{}:{}: more than {} levels deep", name, line, kMaxTomlNesting));
    }
    try {
        std::istringstream stream(text);
        return toml::parse(stream, name);
    } catch (const toml::exception& failure) {
        const std::size_t number = failure.location().line();
        const std::string line = line_of(text, number);
        const std::string what = what_of(failure);
        return make_error(ErrorKind::kConfiguration,
                          fmt::format("{}:{}: not valid TOML: {}, in '{}'; {}",
                                      name,
                                      number,
                                      what,
                                      line,
                                      hint(text, line, what)));
    } catch (const std::exception& failure) {
        return make_error(ErrorKind::kConfiguration,
                          fmt::format("{}: not valid TOML: {}", name, failure.what()));
    }
}

std::string shown(const toml::value& value) {
    constexpr std::size_t kMaxLength = 60;
    return one_line(value).substr(0, kMaxLength);
}

}  // namespace atrium::config
