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

/// A camera's picture of a person as the viewer draws it.
struct Photo {
    int width = 0;
    int height = 0;
    std::vector<std::uint8_t> bgr;  // packed, rows from the top; grey outside the person
    image::Mask opacity;            // 255 if any of the pixel's samples shows the person's surface
};

/// How a photo computes its pixels.
enum class Sampling : std::uint8_t {
    kMean,    // of four samples, as a camera gathers light
    kCentre,  // at the pixel's centre, as the viewer draws; at the person's edge, the mean
};

/// Draws people as the viewer does, but from a calibrated camera with lens distortion, and without
/// the world around them.
///
/// Owns a GL context, which is current from its creation on. Create and destroy the drawn objects
/// during its lifetime.
class PersonPhotographer {
public:
    static Expected<PersonPhotographer> create(Sampling sampling = Sampling::kMean);

    /// Whether people are drawn with soft outlines (renderer::OutlineStrip), as usual.
    void set_soft_outlines(bool are_on) { has_soft_outlines_ = are_on; }

    /// Draws into the bound framebuffer, which is black with alpha 0.
    using Paint =
        std::function<void(const Eigen::Matrix4d& clip_from_site, const Eigen::Vector3d& eye_site)>;
    Photo take(const geometry::CalibratedCamera& camera, const Paint& paint);

    /// Draws as the viewer's scene does.
    Photo take(const geometry::CalibratedCamera& camera, renderer::PersonDrawing& person);

private:
    PersonPhotographer(gl::OffscreenContext context, Sampling sampling)
        : context_(std::move(context)), sampling_(sampling) {}

    gl::OffscreenContext context_;  // destroyed last
    Sampling sampling_;
    bool has_soft_outlines_ = true;
    std::optional<renderer::PersonShaders> shaders_;
    gl::Framebuffer target_;
    std::vector<std::uint8_t> samples_;  // RGBA, bottom row first
};

}  // namespace atrium::test
