#pragma once

#include "core/image/colour_rows.hpp"
#include "site_node/refine/luma_picture.hpp"

#include <cstddef>
#include <span>

namespace atrium::refine {

inline constexpr std::size_t kMostPaths = 3;
inline constexpr float kUnknownScore = -1.0F;  // also that of pictures which are opposite

/// Path of a small patch of surface through one camera's picture, while it moves along a straight
/// line in space. In pixels of the LumaPicture.
struct PatchPath {
    const LumaPicture* picture = nullptr;
    Eigen::Vector2f first_px = Eigen::Vector2f::Zero();  // its centre at the first step
    Eigen::Vector2f last_px = Eigen::Vector2f::Zero();
    float first_depth_m = 1.0F;  // of the centre, along the camera's axis
    float last_depth_m = 1.0F;
    Eigen::Vector2f column_px =
        Eigen::Vector2f::Zero();  // from one sample of the patch to the next
    Eigen::Vector2f row_px = Eigen::Vector2f::Zero();
};

/// Of `num` even steps along the line from the first place to the last: every `stride`-th from
/// `first` on.
struct ScoredSteps {
    std::size_t num = 1;
    std::size_t first = 0;
    std::size_t stride = 1;
};

/// How well the cameras agree in what they show at these steps. Writes to `scores`, which has one
/// element per step of the line, or fewer: then the last steps are left out.
///
/// Patches have 5 x 5 samples less the middle one. Two are compared by zero-mean normalised
/// cross-correlation; of up to three pairs the better two count, so one camera may be wrong. Values
/// are in [-1, 1], kUnknownScore where less than two cameras show the whole patch inside their
/// silhouettes and with contrast. Two or three paths. All instruction sets give the same bits.
void score_depths(std::span<const PatchPath> paths,
                  const ScoredSteps& steps,
                  std::span<float> scores,
                  image::RowCode code = image::best_row_code());

}  // namespace atrium::refine
