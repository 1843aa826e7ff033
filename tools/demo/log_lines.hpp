#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

/// Reads what a program of the demo wrote to its log.
namespace atrium::demo {

/// Returns the last error in `log`; if there is none and `with_warnings`, the last warning. Without
/// time and program. Empty: neither.
std::string last_problem(std::string_view log, bool with_warnings);

/// Returns the warnings in `log` about the world's file and its models, such as
/// "object_looks_wrong ..." and "texture_missing ...": each once, in the order of their last.
std::vector<std::string> doubts(std::string_view log);

/// Returns how far the rendering of a simulated room is [%], if that is what the program does now.
std::optional<int> rendering_percent(std::string_view log);

}  // namespace atrium::demo
