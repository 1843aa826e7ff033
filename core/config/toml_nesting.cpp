#include "core/config/toml_nesting.hpp"

#include <algorithm>

namespace atrium::config {
namespace {

/// Returns the position after the string whose opening quote is at `begin`; the end of the line if
/// a single-line string is not closed.
std::size_t end_of_string(std::string_view toml, std::size_t begin) {
    const char quote = toml[begin];
    const bool has_escapes = quote == '"';
    const auto quotes_at = [&](std::size_t at) {
        return std::min(toml.find_first_not_of(quote, at), toml.size()) - at;
    };
    const std::size_t num_quotes = quotes_at(begin);
    if (num_quotes == 2) return begin + 2;
    const bool has_lines = num_quotes >= 3;
    for (std::size_t at = begin + (has_lines ? 3 : 1); at < toml.size(); ++at) {
        if (toml[at] == '\\' && has_escapes) {
            ++at;
        } else if (toml[at] == '\n' && !has_lines) {
            return at;
        } else if (toml[at] == quote) {
            if (!has_lines) return at + 1;
            // up to two quotes may directly precede the closing three
            if (const std::size_t num = quotes_at(at); num >= 3)
                return at + std::min<std::size_t>(num, 5);
        }
    }
    return toml.size();
}

}  // namespace

std::size_t line_nested_too_deeply(std::string_view toml) {
    std::size_t depth = 0;
    std::size_t num_dots = 0;  // of the current dotted key
    for (std::size_t at = 0; at < toml.size();) {
        const char c = toml[at];
        if (c == '#') {
            at = std::min(toml.find('\n', at), toml.size());
            continue;
        }
        if (c == '"' || c == '\'') {
            at = end_of_string(toml, at);
            continue;
        }
        if (c == '[' || c == '{') ++depth;
        if ((c == ']' || c == '}') && depth > 0) --depth;
        if (c == '.') ++num_dots;
        if (std::string_view("=,[]{}\n").find(c) != std::string_view::npos) num_dots = 0;
        if (depth + num_dots > kMaxTomlNesting) {
            const auto here = toml.begin() + static_cast<std::ptrdiff_t>(at);
            return 1 + static_cast<std::size_t>(std::count(toml.begin(), here, '\n'));
        }
        ++at;
    }
    return 0;
}

}  // namespace atrium::config
