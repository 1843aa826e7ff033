#pragma once

#include <cstdint>
#include <span>
#include <string>

namespace atrium::test {

/// Each reads any bytes as the file that it is named after and, where they are one, holds the
/// result against what its reader promises. Empty: all is well, or refused; else what is wrong.
std::string check_rig_bytes(std::span<const std::uint8_t> bytes, bool& was_accepted);
std::string check_views_bytes(std::span<const std::uint8_t> bytes, bool& was_accepted);
std::string check_profiles_bytes(std::span<const std::uint8_t> bytes, bool& was_accepted);

/// Where the first byte is odd, the last eight bytes become the checksum that the file needs:
/// nothing that a fuzzer does to a file would get past it. The first byte itself is no part of the
/// file.
std::string check_background_bytes(std::span<const std::uint8_t> bytes, bool& was_accepted);

}  // namespace atrium::test
