#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace atrium::monitor {

enum class Look { kPlain, kTitle, kDim, kWarning, kBad };

/// `text` with '?' for all that is not printable ASCII: nothing in it can command a terminal.
std::string printable(std::string_view text);

/// Lines of a limited width, made safe for a terminal.
class TextLines {
public:
    TextLines(std::size_t width, bool colour) : width_(width), colour_(colour) {}

    /// One line; what exceeds the width is cut off.
    void add(std::string_view text, Look look = Look::kPlain);
    /// `head`, then the items with two blanks between them, on as many lines as they need; lines
    /// after the first are indented by the length of the head. Nothing where there are no items.
    void add_items(std::string_view head,
                   const std::vector<std::string>& items,
                   Look look = Look::kPlain);
    /// The same with the words of a sentence, and one blank.
    void add_words(std::string_view head, std::string_view text, Look look = Look::kPlain);
    std::size_t size() const { return lines_.size(); }
    /// Keeps the first ones, and says of the others how many they are, so that there are `height`.
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
