#include "tools/demo/log_lines.hpp"

#include <algorithm>
#include <array>
#include <charconv>

namespace atrium::demo {
namespace {

enum class Weight { kNone, kWarning, kError };

struct LogLine {
    Weight weight = Weight::kNone;
    std::string_view text;
};

std::string_view take_word(std::string_view& rest) {
    const auto length = std::min(rest.find(' '), rest.size());
    const std::string_view word = rest.substr(0, length);
    rest.remove_prefix(std::min(length + 1, rest.size()));
    return word;
}

// A line is `time level program text`; other lines come from libraries and the C++ runtime.
LogLine parse(std::string_view line) {
    std::string_view rest = line;
    const std::string_view time = take_word(rest);
    const std::string_view level = take_word(rest);
    const bool is_ours = time.size() > 10 && time[4] == '-' && time[10] == 'T';
    if (!is_ours) {
        const bool is_error = line.find(": error: ") != std::string_view::npos ||
                              line.starts_with("terminate called") || line.starts_with("  what():");
        return {is_error ? Weight::kError : Weight::kNone, line};
    }
    take_word(rest);  // the program
    if (level == "error") return {Weight::kError, rest};
    return {level == "warning" ? Weight::kWarning : Weight::kNone, rest};
}

// Calls `visit` with each line, the last one first, until it returns false.
template <typename Visit>
void each_from_the_end(std::string_view log, Visit&& visit) {
    while (!log.empty()) {
        if (log.ends_with('\n')) log.remove_suffix(1);
        const auto end = log.rfind('\n');
        const auto begin = end == std::string_view::npos ? 0 : end + 1;
        if (!visit(parse(log.substr(begin)))) return;
        log = log.substr(0, begin);
    }
}

}  // namespace

std::string last_problem(std::string_view log, bool with_warnings) {
    std::string_view error;
    std::string_view warning;
    each_from_the_end(log, [&](const LogLine& line) {
        if (line.weight == Weight::kError) error = line.text;
        if (line.weight == Weight::kWarning && warning.empty()) warning = line.text;
        return error.empty();
    });
    if (!error.empty()) return std::string(error);
    return with_warnings ? std::string(warning) : std::string();
}

std::vector<std::string> doubts(std::string_view log) {
    std::vector<std::string> lines;
    each_from_the_end(log, [&](const LogLine& line) {
        const std::string_view event = line.text.substr(0, line.text.find(' '));
        const bool is_doubt = std::ranges::any_of(
            std::array<std::string_view, 3>{"_looks_wrong", "_not_drawn", "_missing"},
            [&](std::string_view end) { return event.ends_with(end); });
        if (line.weight == Weight::kWarning && is_doubt &&
            std::ranges::find(lines, line.text) == lines.end())
            lines.emplace_back(line.text);
        return true;
    });
    std::ranges::reverse(lines);
    return lines;
}

std::optional<int> rendering_percent(std::string_view log) {
    constexpr std::string_view kBegin = "rendering the simulated room ";
    std::optional<int> percent;
    each_from_the_end(log, [&](const LogLine& line) {
        if (line.weight != Weight::kNone) return true;  // for example that the machine is too slow
        if (!line.text.starts_with(kBegin)) return false;
        const std::string_view number = line.text.substr(kBegin.size());
        int value = 0;
        const auto [end, failure] =
            std::from_chars(number.data(), number.data() + number.size(), value);
        if (failure == std::errc() && value < 100) percent = value;
        return false;
    });
    return percent;
}

}  // namespace atrium::demo
