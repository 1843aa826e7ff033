#pragma once

#include "viewer/renderer/person/camera_blend.hpp"
#include "viewer/renderer/person/person_model.hpp"

#include <Eigen/Core>

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

namespace atrium::exporting {

/// The colours that the viewer gives the points of a triangle. Evaluates for one point what
/// `renderer::shaders::person_fragment` does for one pixel; a test compares both.
class TriangleColours {
public:
    /// `shares`: barycentric coordinates. Red, green, blue in [0, 1], sRGB.
    Eigen::Vector3f at(const Eigen::Vector3f& shares) const;

private:
    friend class SurfaceColours;
    struct Slot {
        const std::uint8_t* layer = nullptr;
        std::array<Eigen::Vector4f, 3> corners;  // s z, t z, z, weight
    };
    std::array<Eigen::Vector3f, 3> fallback_;
    std::array<Slot, renderer::kCamerasPerTriangle.back()> slots_;
    std::size_t num_slots_ = 0;
    int width_ = 0;  // of a layer
    int height_ = 0;
};

/// The colours of a person's surface as the viewer blends them: seen along its normals
/// (`renderer::blend_for_texture`), or, what faces `eye_site`, as seen from there. Refers to the
/// model. Deterministic.
class SurfaceColours {
public:
    explicit SurfaceColours(const renderer::PersonModel& model,
                            const std::optional<Eigen::Vector3f>& eye_site = std::nullopt);

    TriangleColours of(std::uint32_t triangle) const;
    /// Per vertex of the model: the mean over its triangles.
    std::vector<Eigen::Vector3f> at_vertices() const;

private:
    const renderer::PersonModel& model_;
    std::array<renderer::BlendedMesh, 2> blended_;  // along the normals, for the eye
    struct Place {
        std::uint32_t blended = 0;
        std::uint32_t group = 0;
        std::uint32_t index = 0;
    };
    std::vector<Place> places_;  // per triangle
};

}  // namespace atrium::exporting
