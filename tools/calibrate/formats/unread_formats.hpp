#pragma once

#include <string>
#include <string_view>

namespace atrium::calibrate {

/// How a calibration of a program whose format is not read is brought in.
extern const char* const kCureOfOthers;

/// Says what `text` is and how to bring it in, if it is a file of a well-known program whose format
/// is not read; else empty.
std::string unread_format(std::string_view text);

}  // namespace atrium::calibrate
