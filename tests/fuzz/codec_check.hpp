#pragma once

#include <cstdint>
#include <span>
#include <string>

namespace atrium::test {

/// Each function reads any bytes as its format. If they are valid, it checks the result against the
/// decoder's promises. Returns the violation, or "" if all is well or the bytes were refused.
std::string check_mesh_bytes(std::span<const std::uint8_t> bytes, bool& was_accepted);
std::string check_mask_bytes(std::span<const std::uint8_t> bytes, bool& was_accepted);

/// The first two bytes are the size of the mask, little-endian. Mask and colours follow.
std::string check_texture_bytes(std::span<const std::uint8_t> bytes, bool& was_accepted);

}  // namespace atrium::test
