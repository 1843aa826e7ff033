#pragma once

#include <cstddef>
#include <string>
#include <vector>

/// Names of the pictures of a folder.
namespace atrium::calibrate {

/// "cam1_000012_pred" is cam1, 12, _pred. A name that is not of a sequence is all prefix.
struct PictureName {
    std::string prefix;
    std::size_t number = 0;
    std::string tail;
    std::string time_unit = {};  // "milliseconds", ...; empty if the number is no time
};

/// Splits the names of the pictures of one folder, without suffixes. What follows the number is a
/// tail if at least three names share it: `0001_pred`, `0002_pred`, ... are a sequence, `cam1_left`
/// and `cam2_left` are two cameras. So is a last number that all names have behind another one:
/// `0001_0`, `0002_0`, ... If the names have times (picture_times.hpp), the number is the time in
/// nanoseconds.
std::vector<PictureName> split_names(const std::vector<std::string>& names);

}  // namespace atrium::calibrate
