#pragma once

#include "monitor/report.hpp"

#include <cstddef>
#include <string>
#include <vector>

namespace atrium::monitor {

struct TextOptions {
    std::size_t width = 80;          // columns, at least kMinWidth are used
    std::size_t height = 0;          // lines; 0: as many as there are
    bool colour = false;             // ANSI colours
    std::vector<std::string> sites;  // whose cameras are shown in any case; those of the others
                                     // where the height allows it
};

inline constexpr std::size_t kMinWidth = 40;

/// The report as lines of at most `width` columns. All that came from outside is printable ASCII
/// afterwards; with `colour` a line may start and end with a colour's escape sequence, which takes
/// no column.
std::vector<std::string> render_text(const Report& report, const TextOptions& options);

}  // namespace atrium::monitor
