#pragma once

#include "core/base/timestamp.hpp"

#include <string>

namespace atrium::keys {

/// The time in which something may be used: from `begin` until before `end`, in whole seconds.
struct Validity {
    Timestamp begin;
    Timestamp end;
    bool operator==(const Validity&) const = default;
};

/// Clocks of hosts differ: what is made now is valid from this long before.
inline constexpr std::chrono::hours kValidBefore{24};

/// From `kValidBefore` before `now`, in whole seconds, for `days` after it (1..36500).
Validity validity_from(Timestamp now, int days);

/// UTC as "2026-11-24T18:30:00Z", as in permissions.
std::string time_text(Timestamp time);
/// The day of it in UTC: "2026-11-24".
std::string day_text(Timestamp time);

}  // namespace atrium::keys
