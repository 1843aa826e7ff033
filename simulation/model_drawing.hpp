#pragma once

#include "core/gl/resources.hpp"
#include "core/gl/shader_program.hpp"
#include "simulation/model.hpp"

#include <vector>

namespace atrium::simulation {

/// The surface of a model in GL. Create, use and destroy it with its context current.
class ModelDrawing {
public:
    explicit ModelDrawing(const ModelSurface& surface);

    void set_pose(const PosedSkin& skin);

    /// Draws the model with `program`, which must be in use with its camera set. Draws both sides
    /// of every triangle, since models need not be closed.
    void draw(const gl::ShaderProgram& program) const;

private:
    std::vector<ModelPart> parts_;
    std::vector<gl::Texture> textures_;
    gl::VertexArray array_;
    gl::Buffer positions_, normals_, texture_places_, colours_, indices_;
};

}  // namespace atrium::simulation
