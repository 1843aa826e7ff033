#pragma once

#include "core/base/expected.hpp"
#include "core/gl/resources.hpp"
#include "core/gl/shader_program.hpp"
#include "viewer/renderer/person_drawing.hpp"

#include <Eigen/Core>

#include <map>
#include <string>
#include <vector>

namespace atrium::renderer {

/// A place of a camera's picture in the site, and where that is in its layer.
struct SilhouetteCorner {
    Eigen::Vector3f p_site;
    Eigen::Vector2f st;
};

/// The picture of `camera` as a net of triangles, each of three corners, in the plane `distance_m`
/// before it. Lens distortion is undone at the net's knots; cells where it cannot be are left out.
void append_silhouette(const PersonModel::Camera& camera,
                       double distance_m,
                       std::vector<SilhouetteCorner>& corners);

/// What each camera saw of its person, where it stands. Uses the pictures that the person is
/// textured with.
class SilhouetteDrawing {
public:
    static Expected<SilhouetteDrawing> create();

    /// With the eye's viewport and colours set. What is before it hides it; it hides nothing.
    /// Nothing is drawn, and nothing done, for a distance of 0.
    void draw(const std::map<std::string, PersonDrawing>& people,
              const Eigen::Matrix4d& clip_from_world,
              double distance_m);

private:
    SilhouetteDrawing() = default;
    void draw(const PersonDrawing& person,
              const Eigen::Matrix4d& clip_from_world,
              double distance_m);

    gl::ShaderProgram shader_;
    gl::VertexArray layout_;
    gl::Buffer buffer_;
    std::vector<SilhouetteCorner> corners_;
};

}  // namespace atrium::renderer
