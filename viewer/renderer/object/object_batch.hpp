#pragma once

#include "core/gl/resources.hpp"
#include "viewer/renderer/drawing/textures.hpp"
#include "viewer/renderer/object/object_drawing.hpp"
#include "viewer/renderer/object/object_shaders.hpp"

#include <cstddef>
#include <vector>

namespace atrium::renderer {

/// Draws rigid objects, with one instanced call for those of equal mesh, texture and level of
/// detail.
class ObjectBatch {
public:
    ObjectBatch();

    /// The object must stay unchanged until the batch is drawn.
    void add(const ObjectDrawing& object, double radius_px);
    /// Draws and drops all objects, with shaders of kObjectVertex.
    void draw(const ObjectShaders& shaders, const Textures& textures);
    /// Draws and drops all objects with the bound shader, one of shadow_vertex or kObjectVertex.
    void draw_with_bound();

private:
    // memory layout of the shaders
    struct Instance {
        Eigen::Matrix4f world_from_mesh;
        Eigen::Vector3f colour;
    };
    struct Entry {
        const ObjectMesh* mesh;
        std::size_t level;
        const ObjectDrawing* object;
    };
    void prepare();
    std::size_t end_of_alike(std::size_t first) const;
    void draw_alike(std::size_t first, std::size_t end) const;
    void forget();

    gl::Buffer buffer_;
    std::vector<Entry> entries_;
    std::vector<Instance> instances_;
};

}  // namespace atrium::renderer
