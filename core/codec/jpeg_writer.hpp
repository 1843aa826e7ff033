#pragma once

#include "core/base/expected.hpp"
#include "core/image/image.hpp"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

namespace atrium::codec {

/// Returns the quantisation step of all coefficients of a block, luma and chroma, for a quality of
/// 1 to 100 on JPEG's scale: 48 at 50, 14 at 85, 1 at 100.
int quantisation_step(int quality);

/// Writes baseline JPEG, 4:4:4, from planes in full-range BT.601. Use one object per thread.
///
/// Every frequency has the same quantisation step, which minimises the mean squared error at equal
/// size; the example tables of the JPEG standard optimise for the eye at a distance. The Huffman
/// code is fixed and suits these steps. A code per picture would save 0.3 kB per picture and take
/// more than twice the time.
class JpegWriter {
public:
    JpegWriter();
    ~JpegWriter();
    JpegWriter(const JpegWriter&) = delete;
    JpegWriter& operator=(const JpegWriter&) = delete;

    /// Writes one picture. The three planes have the same size, 1 to 65500 px per side. The result
    /// is valid until the next call. Fails with kInternal if the library fails (out of memory).
    Expected<std::span<const std::uint8_t>> write(const image::Plane& y,
                                                  const image::Plane& u,
                                                  const image::Plane& v,
                                                  int quality);

private:
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace atrium::codec
