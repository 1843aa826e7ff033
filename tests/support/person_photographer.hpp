#pragma once

#include "core/base/expected.hpp"
#include "core/geometry/pinhole_camera.hpp"
#include "core/gl/offscreen_context.hpp"
#include "core/gl/resources.hpp"
#include "core/image/image.hpp"
#include "viewer/renderer/person/person_drawing.hpp"

#include <Eigen/Core>

#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

namespace atrium::test {

/// What a camera would see of a person as the viewer shows it.
struct Photo {
    int width = 0;
    int height = 0;
    std::vector<std::uint8_t> bgr;  // packed, rows from the top; grey where the person is not
    image::Mask covered;            // 255 where any of the pixel's samples shows the person
};

/// What a pixel of a photo is.
enum class Sampling : std::uint8_t {
    kMean,    // of four samples, as a camera gathers light
    kCentre,  // what is seen at its centre, as the viewer draws; beside the person's edge, the mean
};

/// Draws people as the viewer does, but from a calibrated camera, lens distortion included, and
/// without the world around them.
///
/// Owns a GL context, which is current from the creation on; what is drawn
/// is made and destroyed while it is.
class PersonPhotographer {
public:
    static Expected<PersonPhotographer> create(Sampling sampling = Sampling::kMean);

    /// Draws something into the bound framebuffer, whose alpha is 0 where nothing is.
    using Paint =
        std::function<void(const Eigen::Matrix4d& clip_from_site, const Eigen::Vector3d& eye_site)>;
    Photo take(const geometry::CalibratedCamera& camera, const Paint& paint);

    /// As the viewer's scene does it.
    Photo take(const geometry::CalibratedCamera& camera, renderer::PersonDrawing& person);

private:
    PersonPhotographer(gl::OffscreenContext context, Sampling sampling)
        : context_(std::move(context)), sampling_(sampling) {}

    gl::OffscreenContext context_;  // goes last
    Sampling sampling_;
    std::optional<renderer::PersonShaders> shaders_;
    gl::Framebuffer target_;
    std::vector<std::uint8_t> samples_;  // RGBA, bottom row first
};

}  // namespace atrium::test
