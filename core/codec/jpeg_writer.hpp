#pragma once

#include "core/base/expected.hpp"
#include "core/image/image.hpp"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

namespace atrium::codec {

/// Width of the steps in which all coefficients of a block are rounded, of luma and chroma alike,
/// for a quality of 1 to 100 on JPEG's scale: 48 at 50, 14 at 85, 1 at 100.
int quantisation_step(int quality);

/// Writes baseline JPEG, 4:4:4, of planes that are already full-range BT.601; one per thread.
///
/// Unlike the JPEG standard's example tables, which hide errors from the eye of somebody who looks
/// at a whole picture from afar, every frequency has the same step: at equal size the mean squared
/// error is smallest. The Huffman code is one that suits such steps; made anew for each picture it
/// would save another 0.3 kB of each and take more than twice the time.
class JpegWriter {
public:
    JpegWriter();
    ~JpegWriter();
    JpegWriter(const JpegWriter&) = delete;
    JpegWriter& operator=(const JpegWriter&) = delete;

    /// The three planes are of one size, neither empty nor wider or higher than 65500. The result
    /// is valid until the next call. Error kInternal where the library fails (no memory).
    Expected<std::span<const std::uint8_t>> write(const image::Plane& y,
                                                  const image::Plane& u,
                                                  const image::Plane& v,
                                                  int quality);

private:
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace atrium::codec
