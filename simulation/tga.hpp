#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace atrium::simulation {

/// B, G, R, A, top row first.
struct TgaPicture {
    int width = 0;
    int height = 0;
    std::vector<std::uint8_t> bgra;
};

/// Decodes a Truevision TGA file, which OpenCV does not read: true colour of 24 or 32 bits or grey,
/// plain or run-length encoded. For untrusted bytes; empty for anything else.
std::optional<TgaPicture> read_tga(std::span<const std::uint8_t> bytes);

}  // namespace atrium::simulation
