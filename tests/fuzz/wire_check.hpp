#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace atrium::test {

using Bytes = std::vector<std::uint8_t>;

/// One topic of core/bus/messages.hpp.
struct WireCheck {
    std::string_view topic;

    /// Treats any bytes as if they came from the network. Checks accepted messages against the
    /// promises of messages.hpp. The first byte modulo 3 selects the meaning of the rest:
    ///   0  payload of a sample, read by Cyclone DDS
    ///   1  payload of the end of an instance, read by Cyclone DDS
    ///   2  values of the wire struct's fields, without Cyclone DDS
    /// Returns the violation, or "" if all is well or the bytes were refused.
    std::string (*check)(std::span<const std::uint8_t> bytes, bool& was_accepted);

    /// A few small inputs that are accepted, the same in every run.
    std::vector<Bytes> (*samples)();
};

/// One check per topic.
std::span<const WireCheck> wire_checks();

}  // namespace atrium::test
