#pragma once

#include "tests/golden/picture_difference.hpp"

#include <filesystem>
#include <string>

namespace atrium::golden {

/// Path of the picture of that name.
std::filesystem::path golden_file(const std::string& name);

/// Replaces the golden picture by `picture`.
void renew_golden(const std::string& name, const renderer::RenderedPicture& picture);

/// Fails the test unless `picture` is within `limits` of the golden one. Then it writes the drawn
/// picture and the differences as pictures into the folder that the failure names.
void expect_golden(const std::string& name,
                   const renderer::RenderedPicture& picture,
                   const Limits& limits);

/// The numbers in readable form.
std::string describe(const PictureDifference& difference);

}  // namespace atrium::golden
