#pragma once

#include <cstdint>
#include <string_view>

namespace atrium::physics {

/// Correction that the world made to an object.
enum class IncidentKind : std::uint8_t {
    kNotFinite,  // state not finite: returned to its start
    kRunaway,    // faster than any cause explains within one tick: returned to its start
    kTorn,       // separated at a joint: returned to its start
    kMisshapen,  // soft object far out of shape: returned to its start
    kLeft,       // left the world's box: returned to its start
    kRemoved     // left the world's box: removed
};
/// Returns a predicate for log lines, such as "left the world and was removed".
std::string_view describe(IncidentKind kind);

struct Incident {
    std::uint32_t object = 0;
    IncidentKind kind = IncidentKind::kLeft;
};

enum class AddResult : std::uint8_t { kAdded, kIdInUse, kWorldFull, kInvalid };

/// Counts since construction.
struct WorldCounters {
    std::uint64_t num_ticks = 0;
    // with at least one contact between a person and an object
    std::uint64_t num_contact_ticks = 0;
    std::uint64_t num_soft_contact_ticks = 0;  // of these, with a soft object
    std::uint64_t num_strays = 0;              // objects that left the world's box
    std::uint64_t num_not_finite = 0;          // objects with a state that was not finite
    std::uint64_t num_runaways = 0;            // objects that became far too fast
    std::uint64_t num_torn = 0;     // objects separated at a joint, or soft objects out of shape
    std::uint64_t num_escapes = 0;  // objects found inside a person
};

}  // namespace atrium::physics
