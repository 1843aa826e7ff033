#pragma once

#include "core/base/executor.hpp"
#include "core/image/image.hpp"
#include "core/image/sparse_mask.hpp"
#include "site_node/segmentation/clean_mask.hpp"
#include "site_node/segmentation/segmentation_options.hpp"

#include <cstdint>

namespace atrium::segmentation_worker {

/// Alpha from which a pixel is foreground.
inline constexpr std::uint8_t kForeground = 128;

/// Makes a mask of `alpha` (rows without padding, in the size of `out`, whose spans it sets to
/// whole rows) as the built-in segmentation does: background outside `areas` (empty: the whole
/// picture), without the specks and holes of `options`. Reads each byte of `alpha`, which another
/// process may change meanwhile: then some pixels have old or new values. Gives way after each 16
/// rows.
void mask_of_alpha(const std::uint8_t* alpha,
                   const image::Mask& areas,
                   const segmentation::SegmentationOptions& options,
                   const GiveWay& give_way,
                   segmentation::CleanScratch& scratch,
                   image::SparseMask& out);

}  // namespace atrium::segmentation_worker
