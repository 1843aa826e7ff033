#pragma once

#include "viewer/control/world_editing.hpp"
#include "viewer/renderer/drawing/shape_mesh.hpp"
#include "viewer/renderer/overlay.hpp"

#include <Eigen/Core>

#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace atrium::viewer {

/// Draws the outline of the selected object, its handles and the numbers of a drag. Widths are
/// shares of the picture's height. Drawing thread only.
class EditShapes {
public:
    /// `mesh`: surface of the selected object in its frame; null: its box. `soft_nodes`: of a soft
    /// object, whose bounds are outlined.
    void append(const EditView& edit,
                const std::shared_ptr<const renderer::ShapeMesh>& mesh,
                const std::vector<Eigen::Vector3f>* soft_nodes,
                const renderer::EyeView& eye,
                std::vector<renderer::Triangle>& triangles,
                std::vector<renderer::Label>& labels);

private:
    void append_readout(const EditView& edit,
                        const renderer::EyeView& eye,
                        std::vector<renderer::Label>& labels);

    std::string drawn_readout_;
    std::shared_ptr<const renderer::TexturePicture> readout_;
    struct Silhouette;
    std::shared_ptr<const Silhouette> silhouette_;  // edges of the last mesh
};

}  // namespace atrium::viewer
