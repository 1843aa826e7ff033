#pragma once

#include "core/gl/resources.hpp"
#include "viewer/renderer/object_drawing.hpp"
#include "viewer/renderer/textures.hpp"

#include <cstddef>
#include <vector>

namespace atrium::renderer {

/// Rigid things, drawn in one go for all that have the same mesh, texture and level of detail.
class ObjectBatch {
public:
    ObjectBatch();

    /// The thing stays as it is until the batch was drawn.
    void add(const ObjectDrawing& object, double radius_px);
    /// Draws and forgets all of them, with a shader of kObjectVertex or of shadow_vertex in use;
    /// without `textures` all are plain.
    void draw(const gl::ShaderProgram& shader, const Textures* textures);

private:
    // as the shaders read it
    struct Instance {
        Eigen::Matrix4f world_from_mesh;
        Eigen::Vector4f colour_and_sectors;
    };
    struct Entry {
        const ObjectMesh* mesh;
        std::size_t level;
        const ObjectDrawing* object;
    };
    void draw_alike(std::size_t first, std::size_t num) const;

    gl::Buffer buffer_;
    std::vector<Entry> entries_;
    std::vector<Instance> instances_;
};

}  // namespace atrium::renderer
