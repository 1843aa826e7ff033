#include "core/app/log.hpp"

#include <spdlog/sinks/stdout_sinks.h>
#include <spdlog/spdlog.h>

namespace atrium::app::log {
namespace {

spdlog::logger& logger() {
    static const std::shared_ptr<spdlog::logger> instance = [] {
        auto made = std::make_shared<spdlog::logger>(
            "atrium", std::make_shared<spdlog::sinks::stderr_sink_mt>());
        made->set_pattern("%Y-%m-%dT%H:%M:%S.%e %l %n %v");
        made->flush_on(spdlog::level::info);
        return made;
    }();
    return *instance;
}

spdlog::level::level_enum to_spdlog(Level level) {
    switch (level) {
        case Level::kDebug:
            return spdlog::level::debug;
        case Level::kInfo:
            return spdlog::level::info;
        case Level::kWarn:
            return spdlog::level::warn;
        case Level::kError:
            return spdlog::level::err;
    }
    return spdlog::level::err;
}

}  // namespace

void set_program(const std::string& name) {
    logger().set_pattern("%Y-%m-%dT%H:%M:%S.%e %l " + name + " %v");
}

void set_level(Level level) { logger().set_level(to_spdlog(level)); }

bool set_level(std::string_view name) {
    for (const auto& [text, level] : {std::pair<std::string_view, Level>{"debug", Level::kDebug},
                                      {"info", Level::kInfo},
                                      {"warn", Level::kWarn},
                                      {"error", Level::kError}}) {
        if (name != text) continue;
        set_level(level);
        return true;
    }
    return false;
}

void write(Level level, std::string_view line) { logger().log(to_spdlog(level), "{}", line); }

std::optional<std::string> OncePerSecond::next(std::string_view line) {
    const std::lock_guard lock(mutex_);
    const auto now = std::chrono::steady_clock::now();
    if (last_ != std::chrono::steady_clock::time_point{} && now - last_ < std::chrono::seconds(1)) {
        ++num_held_back_;
        return std::nullopt;
    }
    last_ = now;
    const std::size_t held_back = std::exchange(num_held_back_, 0);
    return held_back > 0 ? fmt::format("{} held_back={}", line, held_back) : std::string(line);
}

void OncePerSecond::warn(std::string_view line) {
    if (const auto text = next(line)) log::warn("{}", *text);
}

void OncePerSecond::info(std::string_view line) {
    if (const auto text = next(line)) log::info("{}", *text);
}

}  // namespace atrium::app::log
