#pragma once

#include <filesystem>

namespace atrium::capture {

/// True if a PNG or JPEG file ends before its picture does, as after an interrupted copy. Reads
/// only a few bytes. False for other files, and for those that cannot be read.
///
/// Decoders print bare lines about truncated files, and some return a picture that is grey below.
bool is_truncated_picture(const std::filesystem::path& file);

}  // namespace atrium::capture
