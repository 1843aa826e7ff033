#pragma once

#include <string>
#include <vector>

/// Parts of the names of cameras, folders and files.
namespace atrium::calibrate {

/// In lower case; of other alphabets only the Latin letters of Latin-1. Accents are composed.
std::string lower(const std::string& text);

/// Whether a byte is a letter, or a part of a character outside ASCII.
bool is_letter(char c);

/// Whether a byte is neither a letter nor a digit.
bool is_separator(char c);
std::string without_separators_behind(std::string name);

/// Runs of letters of any alphabet, in lower case, and of digits, without leading zeros: "Cam_01b"
/// is cam, 1, b.
std::vector<std::string> tokens(const std::string& text);

/// Whether a token is a run of digits.
bool is_number(const std::string& token);

/// The folders of a label and its last name: "images/cam1" is images, cam1.
std::vector<std::string> parts_of(const std::string& label);

/// The tokens of a label without those that all labels have at the same place from the start or
/// from the end, which say nothing.
std::vector<std::string> telling_tokens(const std::string& label,
                                        const std::vector<std::string>& others);

/// The last number among tokens; empty without any.
std::string last_number(const std::vector<std::string>& name);

/// Names of files without words of calibration that all of them begin or end with: "door" of
/// "door_calib" if there is "window_calib" too. All stay as they are if two would be alike, or one
/// would have no letter.
std::vector<std::string> without_calibration_words(const std::vector<std::string>& names);

/// Names as people count: cam2 before cam10.
std::vector<std::string> in_natural_order(std::vector<std::string> names);

}  // namespace atrium::calibrate
