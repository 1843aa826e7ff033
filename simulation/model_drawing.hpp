#pragma once

#include "core/gl/resources.hpp"
#include "core/gl/shader_program.hpp"
#include "simulation/model.hpp"

#include <vector>

namespace atrium::simulation {

/// A model's surface in GL. Made, used and destroyed while its context is current.
class ModelDrawing {
public:
    explicit ModelDrawing(const ModelSurface& surface);

    void set_pose(const PosedSkin& skin);

    /// Draws all of it with `program`, which is in use and has its camera: both sides of every
    /// triangle, for models need not be closed.
    void draw(const gl::ShaderProgram& program) const;

private:
    std::vector<ModelPart> parts_;
    std::vector<gl::Texture> textures_;
    gl::VertexArray array_;
    gl::Buffer positions_, normals_, texture_places_, colours_, indices_;
};

}  // namespace atrium::simulation
