#include "core/app/progress.hpp"

#include <fmt/format.h>

#include <cmath>

namespace atrium::app {

std::optional<std::string> Progress::update(std::size_t done, Clock::time_point now) {
    if (now - last_ < interval_) return std::nullopt;
    last_ = now;
    std::string line = fmt::format("{} {} of {}", thing_, done, total_);
    const double seconds = std::chrono::duration<double>(now - begin_).count();
    if (done == 0 || seconds <= 0.0) return line;
    const double per_s = static_cast<double>(done) / seconds;
    line += fmt::format(", {:.{}f}/s", per_s, per_s < 9.95 ? 1 : 0);
    if (done < total_) {
        const std::chrono::duration<double> left(static_cast<double>(total_ - done) / per_s);
        line += fmt::format(", {} left", duration_text(left));
    }
    return line;
}

std::string duration_text(std::chrono::duration<double> duration) {
    const auto seconds = std::llround(duration.count());
    if (seconds < 100) return fmt::format("{} s", seconds);
    const auto minutes = (seconds + 30) / 60;
    if (minutes < 60) return fmt::format("{} min", minutes);
    return fmt::format("{} h {} min", minutes / 60, minutes % 60);
}

}  // namespace atrium::app
