#pragma once

#include <filesystem>

namespace atrium::calibrate {

/// Pictures per second that MPEG-4 pictures in an AVI file say themselves (DivX, Xvid), apart from
/// the file's headers, which may say something else. 0 for other files. The bytes may be hostile.
double codec_rate_hz(const std::filesystem::path& file);

}  // namespace atrium::calibrate
