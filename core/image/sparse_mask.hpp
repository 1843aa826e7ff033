#pragma once

#include "core/image/image.hpp"

#include <vector>

namespace atrium::image {

/// Columns [begin, end) of a row.
struct PixelSpan {
    int begin = 0;
    int end = 0;
};

/// A mask, and per row the columns outside of which it is background for certain. What reads or
/// clears the mask can skip the rest.
struct SparseMask {
    Mask mask;
    std::vector<PixelSpan> rows;

    /// Anything may be anywhere, as after writing to `mask` directly.
    void forget() { rows.assign(static_cast<std::size_t>(mask.height), PixelSpan{0, mask.width}); }
};

}  // namespace atrium::image
