#pragma once

#include "core/base/executor.hpp"
#include "core/base/expected.hpp"
#include "tools/simulated_cameras/shown_pictures.hpp"

#include <cstddef>
#include <filesystem>
#include <functional>
#include <stop_token>

namespace atrium::simulated_cameras {

/// Error kConfiguration if `folder` has anything in it, kUnavailable if it cannot be written.
Expected<void> check_recording_folder(const std::filesystem::path& folder);

/// Writes what the cameras show in `seconds` as a recording (docs/conventions.md), as fast as it
/// can: `rig_file` as it is, pictures as JPEG, and their times. `shown` must be in RGB. `progress`:
/// called with the number of instants done and of all.
///
/// Errors of `check_recording_folder`; kUnavailable if a file cannot be written, or after a stop.
/// The folder then keeps what was written.
Expected<void> write_recording(const ShownPictures& shown,
                               const std::filesystem::path& rig_file,
                               double seconds,
                               const std::filesystem::path& folder,
                               Executor& executor,
                               const std::function<void(std::size_t, std::size_t)>& progress,
                               const std::stop_token& stop);

}  // namespace atrium::simulated_cameras
