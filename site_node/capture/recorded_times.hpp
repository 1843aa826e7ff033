#pragma once

#include "core/base/expected.hpp"
#include "core/config/rig.hpp"

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <vector>

namespace atrium::capture {

/// Capture times by frame and camera [ns]; empty: none is known.
using RecordedTimes = std::vector<std::vector<std::optional<std::int64_t>>>;

/// Reads a times.csv (docs/conventions.md, "Recordings"): lines of frame, camera, capture_time_ns.
/// A line with a fourth column is of a picture that is not in the recording. Ignores frames from
/// `num_frames` on. Errors name the line.
Expected<RecordedTimes> read_times(const std::filesystem::path& file,
                                   const config::Rig& rig,
                                   std::size_t num_frames);

/// Error kInvalidData if frames are no instants: the times of one frame are mostly further apart
/// than those of one camera from frame to frame, so that no metaframe would be complete. Too few
/// times are not judged. `file`: for the message.
Expected<void> check_times(const RecordedTimes& times, const std::filesystem::path& file);

}  // namespace atrium::capture
