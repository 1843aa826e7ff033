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

    /// Does with any bytes what is done with those that come from the network, and holds what is
    /// accepted against what messages.hpp promises. The first byte says how the others are read,
    /// modulo 3:
    ///   0  as the payload of a sample, by Cyclone DDS
    ///   1  as the payload of the end of a key, by Cyclone DDS
    ///   2  as values of the wire struct's fields, past Cyclone DDS
    /// Empty: all is well, or refused; else what is wrong.
    std::string (*check)(std::span<const std::uint8_t> bytes, bool& was_accepted);

    /// A few small inputs of that form that are accepted, always the same ones.
    std::vector<Bytes> (*samples)();
};

/// Of every topic.
std::span<const WireCheck> wire_checks();

}  // namespace atrium::test
