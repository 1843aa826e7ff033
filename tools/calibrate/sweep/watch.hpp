#pragma once

#include "core/base/expected.hpp"
#include "site_node/capture/frame_source.hpp"
#include "tools/calibrate/sweep/observer.hpp"
#include "tools/calibrate/sweep/source_options.hpp"

#include <stop_token>

namespace atrium::calibrate {

/// Lets the observer look at a source, and shows on standard error, and in the preview, what is
/// still missing. Live cameras are watched until the observer is complete, or until the stop;
/// newest wins. A recording is read to its end. `options` must be resolved. Errors of the source.
Expected<void> watch(capture::FrameSource& source,
                     const SourceOptions& options,
                     Observer& observer,
                     std::stop_token stop);

}  // namespace atrium::calibrate
