#pragma once

#include <string>

/// Names of cameras in other alphabets. Text is UTF-8; invalid bytes stay as they are.
namespace atrium::calibrate {

/// Joins Latin letters and the accents behind them, as macOS writes the names of files, into one
/// character.
std::string composed(const std::string& text);

/// The name that a rig can have: letters A-Z, a-z, digits, _ . and -, at most 60. Latin letters
/// lose their accents ("Tür" is "Tuer"); any other character becomes one underscore. Empty if no
/// letter and no digit is left.
std::string rig_name(const std::string& original);

}  // namespace atrium::calibrate
