#pragma once

#include "tools/monitor/report.hpp"

#include <cstddef>
#include <string>
#include <vector>

namespace atrium::monitor {

struct TextOptions {
    std::size_t width = 80;  // columns; at least kMinWidth are used
    std::size_t height = 0;  // lines; 0: no limit
    bool colour = false;     // ANSI colours
    /// Sites whose cameras are always shown; without any, all are shown if the height allows.
    std::vector<std::string> sites;
};

inline constexpr std::size_t kMinWidth = 40;

/// Renders the report as lines of at most `width` columns. Replaces everything that is not
/// printable ASCII. With `colour` a line may start and end with an escape sequence, which takes no
/// column.
std::vector<std::string> render_text(const Report& report, const TextOptions& options);

}  // namespace atrium::monitor
