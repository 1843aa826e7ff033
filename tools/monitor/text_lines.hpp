#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace atrium::monitor {

enum class Look { kPlain, kTitle, kDim, kWarning, kBad };

/// Replaces everything but printable ASCII by '?', so no text can send commands to a terminal.
std::string printable(std::string_view text);

/// Builds lines of limited width that are safe for a terminal.
class TextLines {
public:
    TextLines(std::size_t width, bool colour) : width_(width), colour_(colour) {}

    /// Adds one line, cut at the width.
    void add(std::string_view text, Look look = Look::kPlain);
    /// Adds `head` and the items, separated by two blanks, on as many lines as they need. Indents
    /// further lines by the length of the head. Adds nothing without items.
    void add_items(std::string_view head,
                   const std::vector<std::string>& items,
                   Look look = Look::kPlain);
    /// Adds `head` and the words of a sentence, wrapped at the width.
    void add_words(std::string_view head, std::string_view text, Look look = Look::kPlain);
    std::size_t size() const { return lines_.size(); }
    /// Cuts to `height` lines. The last line tells how many were cut.
    void cut(std::size_t height);
    std::vector<std::string> take() { return std::move(lines_); }

private:
    void add_list(std::string_view head,
                  const std::vector<std::string>& items,
                  std::string_view between,
                  Look look);

    std::size_t width_;
    bool colour_;
    std::vector<std::string> lines_;
};

}  // namespace atrium::monitor
