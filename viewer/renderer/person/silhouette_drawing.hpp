#pragma once

#include "core/base/expected.hpp"
#include "core/gl/resources.hpp"
#include "core/gl/shader_program.hpp"
#include "viewer/renderer/person/person_drawing.hpp"

#include <Eigen/Core>

#include <map>
#include <string>
#include <vector>

namespace atrium::renderer {

/// A vertex of a camera's picture in the site, with its texture coordinates.
struct SilhouetteCorner {
    Eigen::Vector3f p_site;
    Eigen::Vector2f st;
};

/// Appends the picture of `camera` as a grid of triangles, three vertices each, in the plane
/// `distance_m` before it. Undoes the lens distortion at the grid points. Skips cells where that is
/// impossible.
void append_silhouette(const PersonModel::Camera& camera,
                       double distance_m,
                       std::vector<SilhouetteCorner>& corners);

/// Draws each camera's picture of its person at the camera's pose. Reuses the pictures that texture
/// the person.
class SilhouetteDrawing {
public:
    static Expected<SilhouetteDrawing> create();

    /// Draws with the eye's viewport and colour mask set. The scene hides the pictures, but they
    /// hide nothing. Does nothing at a distance of 0.
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
