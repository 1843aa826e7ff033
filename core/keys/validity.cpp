#include "core/keys/validity.hpp"

#include <fmt/chrono.h>

#include <ctime>

namespace atrium::keys {
namespace {

constexpr std::int64_t kSecond_ns = 1'000'000'000;

std::tm utc(Timestamp time) { return fmt::gmtime(static_cast<std::time_t>(time.ns / kSecond_ns)); }

}  // namespace

Validity validity_from(Timestamp now, int days) {
    const Timestamp second{now.ns - now.ns % kSecond_ns};
    return {second + -kValidBefore, second + std::chrono::hours(24) * days};
}

std::string time_text(Timestamp time) { return fmt::format("{:%Y-%m-%dT%H:%M:%SZ}", utc(time)); }

std::string day_text(Timestamp time) { return fmt::format("{:%Y-%m-%d}", utc(time)); }

}  // namespace atrium::keys
