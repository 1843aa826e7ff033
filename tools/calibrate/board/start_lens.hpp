#pragma once

#include "core/base/expected.hpp"
#include "tools/calibrate/board/views.hpp"

#include <cstddef>
#include <vector>

namespace atrium::calibrate {

/// Sets the lens of a camera from its own views of boards, without a guess: the focal length from
/// the homographies with the principal point in the middle (Zhang, 2000), then an adjustment of
/// this camera alone, from that and from other focal lengths, of which the best is kept.
///
/// `views` are of all cameras. Needs three views of the camera. Returns the RMS error [px]. Error
/// kInvalidData if no lens explains the views.
Expected<double> start_lens(Bundle& bundle,
                            std::size_t camera,
                            const std::vector<BoardView>& views,
                            LensFreedom freedom,
                            int num_threads);

}  // namespace atrium::calibrate
