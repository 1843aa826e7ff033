#pragma once

#include "tests/support/pictures/filmed_person.hpp"
#include "tests/support/pictures/person_photographer.hpp"
#include "viewer/renderer/person/person_model.hpp"

#include <filesystem>
#include <span>
#include <vector>

/// Auxiliary pictures of texture_quality.
namespace atrium::bench {

/// The truth and the photos of one view in a row, cropped to the person.
void write_side_by_side(const std::filesystem::path& file,
                        const test::TruePicture& truth,
                        const std::vector<test::Photo>& photos);

/// The texture's version of its camera's picture, of `width` by `height`. No display at the
/// camera's own pose should do better.
test::Photo enlarged(const renderer::CameraPicture& picture, int width, int height);

/// Replaces the cameras' pictures by the simulated person's own colours: the colours of the
/// surroundings must not mix into the pixels at the outline.
void show_person_alone(std::span<const geometry::CalibratedCamera> rig,
                       const simulation::RoomOptions& room,
                       double time_s,
                       std::vector<test::TruePicture>& pictures);

/// The person alone as a camera with pixels twice as large would see it. It has the size of the
/// textures, and each pixel is the mean of those of four pixels that are inside the mask.
test::TruePicture halved(const test::TruePicture& from);

/// Where a photo and the truth differ in what is the person, as shares of the true mask.
struct OutlineError {
    double bare = 0.0;    // of the mask, not covered
    double beyond = 0.0;  // covered, outside the mask
};
OutlineError outline_error(const test::TruePicture& truth, const test::Photo& photo);

}  // namespace atrium::bench
