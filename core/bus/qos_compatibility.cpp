#include "core/bus/qos_profiles.hpp"

#include <fmt/format.h>

namespace atrium::bus {

namespace {

std::string text_of(std::chrono::nanoseconds duration) {
    if (duration == kForever) return "forever";
    return fmt::format("{} s", std::chrono::duration<double>(duration).count());
}

/// The endpoint's value of a policy, as in the file.
std::string text_of(std::string_view policy, const EndpointQos& qos) {
    if (policy == "reliability")
        return qos.reliable ? "RELIABLE_RELIABILITY_QOS" : "BEST_EFFORT_RELIABILITY_QOS";
    if (policy == "durability")
        return qos.transient_local ? "TRANSIENT_LOCAL_DURABILITY_QOS" : "VOLATILE_DURABILITY_QOS";
    if (policy == "deadline") return text_of(qos.deadline);
    if (policy == "liveliness") return text_of(qos.lease);
    return text_of(qos.latency_budget);
}

}  // namespace

std::string_view incompatible_policy(const EndpointQos& offered, const EndpointQos& requested) {
    if (requested.reliable && !offered.reliable) return "reliability";
    if (requested.transient_local && !offered.transient_local) return "durability";
    if (requested.deadline < offered.deadline) return "deadline";
    if (requested.lease < offered.lease) return "liveliness";
    if (requested.latency_budget < offered.latency_budget) return "latency_budget";
    return {};
}

Expected<void> check_compatible(const QosProfiles& profiles, const std::string& source) {
    for (const auto& [name, profile] : profiles) {
        const std::string_view policy = incompatible_policy(profile.writer, profile.reader);
        if (policy.empty()) continue;
        return make_error(ErrorKind::kConfiguration,
                          fmt::format("{}: profile '{}': <datareader_qos> <{}> requests {}, more "
                                      "than <datawriter_qos> <{}> offers, {}; they would never be "
                                      "matched",
                                      source,
                                      name,
                                      policy,
                                      text_of(policy, profile.reader),
                                      policy,
                                      text_of(policy, profile.writer)));
    }
    return {};
}

}  // namespace atrium::bus
