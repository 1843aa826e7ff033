#pragma once

#include "core/base/expected.hpp"

#include <cstdint>
#include <memory>
#include <span>

namespace atrium::codec {

/// Resolution of the colours beside that of the brightness.
enum class Chroma : std::uint8_t {
    kHalf,  // 4:2:0
    kFull   // 4:4:4
};

/// Encodes whole pictures as baseline JPEG with TurboJPEG, for display. For the textures of people
/// use TextureEncoder. Reuses its memory; use one per thread.
class PictureEncoder {
public:
    PictureEncoder();
    ~PictureEncoder();
    PictureEncoder(const PictureEncoder&) = delete;
    PictureEncoder& operator=(const PictureEncoder&) = delete;

    /// Encodes `rgba`: width * height pixels of R, G, B, A, rows from the top; alpha is ignored.
    /// `quality` is 1 to 100 on JPEG's scale. The result is valid until the next call. Fails with
    /// kInvalidData if `rgba` has another size, with kInternal if the library fails (out of
    /// memory).
    Expected<std::span<const std::uint8_t>> encode(std::span<const std::uint8_t> rgba,
                                                   int width,
                                                   int height,
                                                   int quality,
                                                   Chroma chroma = Chroma::kHalf);

private:
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace atrium::codec
