#pragma once

#include <fmt/format.h>

#include <chrono>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

/// Writes the structured log: lines `time level program event key=value ...` on standard error,
/// through spdlog. Thread-safe.
namespace atrium::app::log {

enum class Level { kDebug, kInfo, kWarn, kError };

void set_program(const std::string& name);
void set_level(Level level);
/// Sets the level by name: "debug", "info", "warn" or "error". Returns false for any other name.
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

/// Logs at most one line per second and adds the number of suppressed lines (`held_back=`). For
/// events that a hostile or broken peer can cause at any rate. Thread-safe.
class OncePerSecond {
public:
    void warn(std::string_view line);
    void info(std::string_view line);

private:
    /// Returns the line to log with the number of lines suppressed before it; nullopt if this line
    /// is suppressed as well.
    std::optional<std::string> next(std::string_view line);

    std::mutex mutex_;
    std::chrono::steady_clock::time_point last_{};
    std::size_t num_held_back_ = 0;
};

}  // namespace atrium::app::log
