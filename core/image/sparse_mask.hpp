#pragma once

#include "core/image/image.hpp"

#include <vector>

namespace atrium::image {

/// Columns [begin, end) of a row.
struct PixelSpan {
    int begin = 0;
    int end = 0;
};

/// A mask with a span of columns per row; outside the span it is background. Readers and clearing
/// can skip the rest.
struct SparseMask {
    Mask mask;
    std::vector<PixelSpan> rows;

    /// Resets the spans to whole rows. Required after writing to `mask` directly.
    void forget() { rows.assign(static_cast<std::size_t>(mask.height), PixelSpan{0, mask.width}); }
};

}  // namespace atrium::image
