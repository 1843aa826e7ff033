#pragma once

#include "core/base/expected.hpp"

#include <cstdint>
#include <memory>
#include <span>

namespace atrium::codec {

/// Codes whole pictures for people to look at: baseline JPEG, 4:2:0, by turbojpeg. The coder of a
/// person's textures is TextureEncoder. Holds the library's state and memory that is reused; one
/// per thread.
class PictureEncoder {
public:
    PictureEncoder();
    ~PictureEncoder();
    PictureEncoder(const PictureEncoder&) = delete;
    PictureEncoder& operator=(const PictureEncoder&) = delete;

    /// `rgba` holds width * height pixels of R, G, B, A, rows from the top; alpha is ignored.
    /// `quality` is 1 to 100 on JPEG's scale. The result is valid until the next call. Errors:
    /// kInvalidData where `rgba` has another size, kInternal where the library fails (no memory).
    Expected<std::span<const std::uint8_t>> encode(std::span<const std::uint8_t> rgba,
                                                   int width,
                                                   int height,
                                                   int quality);

private:
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace atrium::codec
