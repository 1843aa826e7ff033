#pragma once

#include <optional>
#include <string>
#include <string_view>

/// Reads what a program of the demo wrote to its log.
namespace atrium::demo {

/// Returns the last error in `log`; if there is none and `with_warnings`, the last warning. Without
/// time and program. Empty: neither.
std::string last_problem(std::string_view log, bool with_warnings);

/// Returns how far the rendering of a simulated room is [%], if that is what the program does now.
std::optional<int> rendering_percent(std::string_view log);

}  // namespace atrium::demo
