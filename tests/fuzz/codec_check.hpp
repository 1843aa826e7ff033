#pragma once

#include <cstdint>
#include <span>
#include <string>

namespace atrium::test {

/// Each reads any bytes as what it is named after and, where they are one, holds the result against
/// what the decoder promises. Empty: all is well, or refused; else what is wrong.
std::string check_mesh_bytes(std::span<const std::uint8_t> bytes, bool& was_accepted);
std::string check_mask_bytes(std::span<const std::uint8_t> bytes, bool& was_accepted);

/// The first two bytes are the size of the mask, little-endian, then come mask and colours.
std::string check_texture_bytes(std::span<const std::uint8_t> bytes, bool& was_accepted);

}  // namespace atrium::test
