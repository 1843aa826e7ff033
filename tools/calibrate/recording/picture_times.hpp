#pragma once

#include "tools/calibrate/recording/picture_names.hpp"

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

/// Times in the names of pictures.
namespace atrium::calibrate {

/// Splits the names of the pictures of one folder, without suffixes, at their times. The times are
/// nanoseconds of any clock. Understood are
///
/// - Unix times: 1779186104123 (13 digits), with 16 or 19 digits, 1779186104.123
/// - dates: 2026-05-19_10-21-44-123, 20260519T102144_123456
/// - seconds with decimals: 0.133
/// - times of day: 10-21-44-123
///
/// A running number beside the time is dropped. Empty if the names of fewer than four pictures, or
/// of few of all, have times, or if these do not count as a camera does: equal ones, or less than a
/// millisecond or more than ten seconds apart. So a date before a running number is no time.
std::optional<std::vector<PictureName>> split_at_times(const std::vector<std::string>& names);

/// What plain numbers count if they look like times: with steps that are about equal.
struct UnitOfNumbers {
    std::string_view name;      // "milliseconds", ...
    std::uint64_t nanoseconds;  // of one
};
/// The unit with which the numbers of the pictures, by camera and ascending, have between 0.5 and
/// 500 pictures per second. Empty if they do not look like times, or are few.
std::optional<UnitOfNumbers> unit_of_numbers(
    const std::vector<std::vector<std::uint64_t>>& cameras);

}  // namespace atrium::calibrate
