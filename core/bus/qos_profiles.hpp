#pragma once

#include "core/base/expected.hpp"

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <string_view>

/// Reads QoS profiles from OMG DDS-XML, the subset that Atrium uses.
namespace atrium::bus {

inline constexpr std::int32_t kUnlimited = -1;
inline constexpr std::chrono::nanoseconds kForever = std::chrono::nanoseconds::max();

struct ResourceLimits {
    std::int32_t max_samples = kUnlimited;
    std::int32_t max_instances = kUnlimited;
    std::int32_t max_samples_per_instance = kUnlimited;
};

struct History {
    bool keep_all = false;
    std::int32_t depth = 1;  // ignored with keep_all
};

/// QoS of a writer or reader. The defaults are those of DDS.
struct EndpointQos {
    bool reliable = false;
    std::chrono::nanoseconds max_blocking_time = std::chrono::milliseconds(100);
    bool transient_local = false;
    History history;
    ResourceLimits limits;
    History late_joiner_history;  // durability_service; writers only
    ResourceLimits late_joiner_limits;
    std::chrono::nanoseconds lease = kForever;     // automatic liveliness
    std::chrono::nanoseconds deadline = kForever;  // between two samples of an instance
    std::chrono::nanoseconds latency_budget{0};
    /// Writers only; counted from the write, and anew from arrival.
    std::chrono::nanoseconds lifespan = kForever;
};

struct QosProfile {
    EndpointQos writer;
    EndpointQos reader;
};

using QosProfiles = std::map<std::string, QosProfile, std::less<>>;

/// Returns the XML element name of the first policy of which the reader requests more than the
/// writer offers. Such endpoints are never matched. Empty if they are compatible.
std::string_view incompatible_policy(const EndpointQos& offered, const EndpointQos& requested);

/// Fails with kConfiguration if the reader of a profile requests more than its writer offers. The
/// message names both elements and their values.
Expected<void> check_compatible(const QosProfiles& profiles, const std::string& source);

/// Parses profiles; `source` names the text in errors. Unknown elements, policies and values are
/// errors that name the profile and the allowed ones, because an ignored QoS would only show as two
/// programs that are never matched. Also fails as check_compatible does.
Expected<QosProfiles> parse_qos_profiles(std::string_view xml, const std::string& source);

/// Reads and parses the file; the built-in copy of qos/profiles.xml if `file` is empty.
Expected<QosProfiles> load_qos_profiles(const std::filesystem::path& file);

}  // namespace atrium::bus
