#pragma once

#include "tests/golden/picture_difference.hpp"

#include <filesystem>
#include <string>

namespace atrium::golden {

/// Where the picture of that name lies.
std::filesystem::path golden_file(const std::string& name);

/// Puts `picture` in its place.
void renew_golden(const std::string& name, const renderer::RenderedPicture& picture);

/// A test's failure where `picture` is not within `limits` of the golden one; what was drawn and
/// where it differs then lie as pictures in the folder that the failure names.
void expect_golden(const std::string& name,
                   const renderer::RenderedPicture& picture,
                   const Limits& limits);

/// The numbers, for people.
std::string describe(const PictureDifference& difference);

}  // namespace atrium::golden
