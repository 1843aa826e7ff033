#pragma once

#include "tests/support/filmed_person.hpp"
#include "tests/support/person_photographer.hpp"
#include "viewer/renderer/person/person_model.hpp"

#include <filesystem>
#include <vector>

/// Pictures around those of texture_quality.
namespace atrium::bench {

/// The truth and the photos of the same view in a row, cut to where the person is.
void write_side_by_side(const std::filesystem::path& file,
                        const test::TruePicture& truth,
                        const std::vector<test::Photo>& photos);

/// What the texture alone has kept of its camera's picture, of `width` by `height`: no way to show
/// it at the camera's own pose is expected to do better.
test::Photo enlarged(const renderer::CameraPicture& picture, int width, int height);

/// As a camera with pixels twice as large would have seen the person alone: of the size of the
/// textures, each pixel the mean of those of four that are inside the mask.
test::TruePicture halved(const test::TruePicture& from);

}  // namespace atrium::bench
