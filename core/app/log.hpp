#pragma once

#include <fmt/format.h>

#include <chrono>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

/// The one structured log: lines `time level program event key=value ...` on standard error,
/// through spdlog.
namespace atrium::app::log {

enum class Level { kDebug, kInfo, kWarn, kError };

void set_program(const std::string& name);
void set_level(Level level);
/// "debug", "info", "warn" or "error"; false for anything else.
bool set_level(std::string_view name);
void write(Level level, std::string_view line);

template <typename... Args>
void debug(fmt::format_string<Args...> text, Args&&... args) {
    write(Level::kDebug, fmt::format(text, std::forward<Args>(args)...));
}
template <typename... Args>
void info(fmt::format_string<Args...> text, Args&&... args) {
    write(Level::kInfo, fmt::format(text, std::forward<Args>(args)...));
}
template <typename... Args>
void warn(fmt::format_string<Args...> text, Args&&... args) {
    write(Level::kWarn, fmt::format(text, std::forward<Args>(args)...));
}
template <typename... Args>
void error(fmt::format_string<Args...> text, Args&&... args) {
    write(Level::kError, fmt::format(text, std::forward<Args>(args)...));
}

/// Lets one line through per second and says how many it held back: for what a hostile or broken
/// peer can cause at any rate. Thread-safe.
class OncePerSecond {
public:
    void warn(std::string_view line);
    void info(std::string_view line);

private:
    /// The line, and how many were held back before it; nothing: it is held back too.
    std::optional<std::string> next(std::string_view line);

    std::mutex mutex_;
    std::chrono::steady_clock::time_point last_{};
    std::size_t num_held_back_ = 0;
};

}  // namespace atrium::app::log
