#pragma once

#include "core/base/expected.hpp"
#include "core/gl/resources.hpp"
#include "core/gl/shader_program.hpp"
#include "viewer/renderer/drawing/object_look.hpp"
#include "viewer/renderer/drawing/screen_square.hpp"
#include "viewer/renderer/drawing/view_camera.hpp"

#include <Eigen/Core>

#include <array>
#include <map>
#include <memory>
#include <span>
#include <vector>

namespace atrium::renderer {

/// A small picture at a point in the world. It faces every eye, has a constant size in the picture,
/// and is in front of everything.
struct Label {
    std::shared_ptr<const TexturePicture> picture;       // colours multiplied by alpha
    Eigen::Vector3d at_world = Eigen::Vector3d::Zero();  // centre of its lower edge
    double height = 0.04;                                // share of the eye's picture height
    double opacity = 1.0;
    double raised = 0.0;  // moved up in the picture, in heights of the label
};

/// A straight line in the world. Fainter where the scene hides it.
struct Line {
    struct End {
        Eigen::Vector3f at_world;
        Eigen::Vector3f colour;  // sRGB in [0, 1]
    };
    End from;
    End to;
};

/// A filled triangle in the world, in front of everything.
struct Triangle {
    std::array<Line::End, 3> corners;
};

/// Sets the width of lines and wires for that eye's part of the picture: one pixel for each 720 of
/// its height, or less where the driver draws no such lines.
void set_line_width(const EyeView& eye);

/// Draws over the scene, into each eye's part of the picture and in each eye's colours. So it works
/// on every display, and in screenshots and videos.
class Overlay {
public:
    static Expected<Overlay> create();

    /// Replaces all labels. Drops pictures that no label uses any more.
    void set_labels(std::vector<Label> labels);

    /// Replaces all lines.
    void set_lines(std::span<const Line> lines);

    /// Replaces all triangles.
    void set_triangles(std::span<const Triangle> triangles);

    /// Whether people and objects are drawn as wireframe.
    bool is_wireframe() const { return is_wireframe_; }
    void set_wireframe(bool is_wireframe) { is_wireframe_ = is_wireframe; }

    /// Distance of the camera pictures of people from their cameras [m]. 0: not drawn.
    double silhouettes_m() const { return silhouettes_m_; }
    void set_silhouettes(double distance_m) { silhouettes_m_ = distance_m; }

    /// Draws the lines, tested against the depths of the scene. The caller has set the eye's
    /// viewport and colour mask.
    void draw_lines(const EyeView& eye) const;
    /// Draws the triangles over everything, in their order, without depths. The caller has set the
    /// eye's viewport and colour mask.
    void draw_triangles(const EyeView& eye) const;
    /// Draws the labels over everything, without depths. The caller has set the eye's viewport and
    /// colour mask.
    void draw_labels(const EyeView& eye) const;

private:
    Overlay() = default;
    void draw_label(const Label& label, const EyeView& eye) const;

    gl::ShaderProgram label_shader_;
    ScreenSquare square_;
    std::vector<Label> labels_;
    std::map<std::shared_ptr<const TexturePicture>, gl::Texture> pictures_;
    gl::ShaderProgram line_shader_;
    gl::VertexArray line_layout_;
    gl::Buffer line_ends_;
    std::size_t num_lines_ = 0;
    gl::VertexArray triangle_layout_;
    gl::Buffer triangle_corners_;
    std::size_t num_triangles_ = 0;
    bool is_wireframe_ = false;
    double silhouettes_m_ = 0.0;
};

}  // namespace atrium::renderer
