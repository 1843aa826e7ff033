#pragma once

#include <cstdint>
#include <span>
#include <string>

namespace atrium::test {

/// Each function reads any bytes as its kind of file. If they are valid, it checks the result
/// against the reader's promises. Returns the violation, or "" if all is well or the bytes were
/// refused.
std::string check_rig_bytes(std::span<const std::uint8_t> bytes, bool& was_accepted);
std::string check_views_bytes(std::span<const std::uint8_t> bytes, bool& was_accepted);
std::string check_profiles_bytes(std::span<const std::uint8_t> bytes, bool& was_accepted);

/// If the first byte is odd, the last eight bytes are replaced by the checksum that the file needs.
/// Otherwise no mutation of a fuzzer would pass the checksum. The first byte is not part of the
/// file.
std::string check_background_bytes(std::span<const std::uint8_t> bytes, bool& was_accepted);

/// A frames.raw. If the first byte is odd, all sums are made right, as far as the file can be
/// followed. The first byte is not part of the file.
std::string check_raw_bytes(std::span<const std::uint8_t> bytes, bool& was_accepted);

/// A recording (MCAP): opens it, plays it, seeks in it and repairs it. Accepted: it has topics of
/// Atrium. A chunk or summary whose CRC is 0 has none, so that mutations reach what is behind.
std::string check_recording_bytes(std::span<const std::uint8_t> bytes, bool& was_accepted);

/// A bundle of keys. Accepted: it was parsed. It is then also checked, at noon of a day on which
/// the seeds are valid.
std::string check_bundle_bytes(std::span<const std::uint8_t> bytes, bool& was_accepted);

}  // namespace atrium::test
