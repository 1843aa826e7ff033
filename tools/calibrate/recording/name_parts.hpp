#pragma once

#include <string>
#include <vector>

/// Parts of the names of cameras, folders and files.
namespace atrium::calibrate {

/// In lower case; bytes outside ASCII stay.
std::string lower(std::string text);

/// Runs of letters, in lower case, and of digits, without leading zeros: "Cam_01b" is cam, 1, b.
std::vector<std::string> tokens(const std::string& text);

/// Whether a token is a run of digits.
bool is_number(const std::string& token);

/// The folders of a label and its last name: "images/cam1" is images, cam1.
std::vector<std::string> parts_of(const std::string& label);

}  // namespace atrium::calibrate
