#pragma once

#include <chrono>
#include <compare>
#include <cstdint>

namespace atrium {

/// Absolute time in nanoseconds since the Unix epoch, as on the wire.
struct Timestamp {
    std::int64_t ns = 0;

    static Timestamp now() {
        const auto since_epoch = std::chrono::system_clock::now().time_since_epoch();
        return {std::chrono::duration_cast<std::chrono::nanoseconds>(since_epoch).count()};
    }

    auto operator<=>(const Timestamp&) const = default;
};

inline std::chrono::nanoseconds operator-(Timestamp a, Timestamp b) {
    return std::chrono::nanoseconds(a.ns - b.ns);
}
inline std::chrono::nanoseconds from_milliseconds(double ms) {
    return std::chrono::nanoseconds(static_cast<std::int64_t>(ms * 1e6));
}
inline double milliseconds(std::chrono::nanoseconds d) {
    return std::chrono::duration<double, std::milli>(d).count();
}
inline Timestamp operator+(Timestamp t, std::chrono::nanoseconds d) { return {t.ns + d.count()}; }

}  // namespace atrium
