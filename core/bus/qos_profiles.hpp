#pragma once

#include "core/base/expected.hpp"

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <string_view>

/// Reads QoS profiles in the form of OMG DDS-XML: the part of it that Atrium uses.
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
    std::int32_t depth = 1;  // where not keep_all
};

/// QoS of a writer or a reader; the defaults are those of DDS.
struct EndpointQos {
    bool reliable = false;
    std::chrono::nanoseconds max_blocking_time = std::chrono::milliseconds(100);
    bool transient_local = false;
    History history;
    ResourceLimits limits;
    History late_joiner_history;  // durability_service, of writers
    ResourceLimits late_joiner_limits;
    std::chrono::nanoseconds lease = kForever;     // automatic liveliness
    std::chrono::nanoseconds deadline = kForever;  // between two samples of a key
    std::chrono::nanoseconds latency_budget{0};
    std::chrono::nanoseconds lifespan = kForever;  // of writers; counted anew where it arrives
};

struct QosProfile {
    EndpointQos writer;
    EndpointQos reader;
};

using QosProfiles = std::map<std::string, QosProfile, std::less<>>;

/// Why a reader would never hear a writer: the policy of which it asks for more than is offered, as
/// the name of its element; empty where they fit.
std::string_view incompatible_policy(const EndpointQos& offered, const EndpointQos& requested);

/// Where a profile's reader asks for more than its writer offers: kConfiguration, naming both
/// elements and their values.
Expected<void> check_compatible(const QosProfiles& profiles, const std::string& source);

/// `source` names the text in errors. An element, policy or value that is not known is an error
/// that names it, the profile and what is allowed, and so is a profile that does not fit itself: a
/// QoS that is silently ignored would show only as two programs that do not find each other.
Expected<QosProfiles> parse_qos_profiles(std::string_view xml, const std::string& source);

/// Of the file; of the built-in copy of qos/profiles.xml where `file` is empty.
Expected<QosProfiles> load_qos_profiles(const std::filesystem::path& file);

}  // namespace atrium::bus
