#include "tools/monitor/text_lines.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <sstream>
#include <utility>

namespace atrium::monitor {
namespace {

const char* escape_of(Look look) {
    switch (look) {
        case Look::kPlain:
            return "";
        case Look::kTitle:
            return "\033[1m";
        case Look::kDim:
            return "\033[2m";
        case Look::kWarning:
            return "\033[33m";
        case Look::kBad:
            return "\033[31m";
    }
    return "";
}

}  // namespace

std::string printable(std::string_view text) {
    std::string safe(text);
    std::replace_if(
        safe.begin(), safe.end(), [](char c) { return c < ' ' || c > '~'; }, '?');
    return safe;
}

void TextLines::add(std::string_view text, Look look) {
    const std::string line = printable(text.substr(0, width_));
    if (colour_ && look != Look::kPlain)
        lines_.push_back(escape_of(look) + line + "\033[0m");
    else
        lines_.push_back(line);
}

void TextLines::add_list(std::string_view head,
                         const std::vector<std::string>& items,
                         std::string_view between,
                         Look look) {
    if (items.empty()) return;
    const std::string indent(head.size(), ' ');
    std::string line(head);
    bool is_first = true;
    for (const std::string& item : items) {
        if (!is_first && line.size() + between.size() + item.size() > width_) {
            add(line, look);
            line = indent;
            is_first = true;
        }
        if (!std::exchange(is_first, false)) line += between;
        line += item;
    }
    add(line, look);
}

void TextLines::add_items(std::string_view head, const std::vector<std::string>& items, Look look) {
    add_list(head, items, "  ", look);
}

void TextLines::add_words(std::string_view head, std::string_view text, Look look) {
    std::vector<std::string> words;
    std::istringstream stream{std::string(text)};
    for (std::string word; stream >> word;) words.push_back(word);
    add_list(head, words, " ", look);
}

void TextLines::cut(std::size_t height) {
    if (lines_.size() <= height || height == 0) return;
    const std::size_t num_hidden = lines_.size() - (height - 1);
    lines_.resize(height - 1);
    add(fmt::format("... {} more lines in a taller window", num_hidden), Look::kDim);
}

}  // namespace atrium::monitor
