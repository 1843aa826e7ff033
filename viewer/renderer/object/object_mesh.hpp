#pragma once

#include "core/gl/resources.hpp"
#include "viewer/renderer/drawing/object_look.hpp"

#include <array>
#include <cstddef>
#include <map>
#include <memory>
#include <tuple>

namespace atrium::renderer {

/// A mesh in GL memory, shared by all objects of that look.
struct ObjectMesh {
    struct Level {
        std::size_t first = 0;  // in `indices`
        int num_indices = 0;
    };

    gl::VertexArray layout;
    gl::Buffer corners;
    gl::Buffer indices;
    gl::Buffer colours;
    bool has_colours = false;
    std::array<Level, 3> levels;  // fewer triangles with each level
    Eigen::Vector3d half_extent = Eigen::Vector3d::Zero();

    /// Coarsest level without a visible difference at a radius of `radius_px`.
    static std::size_t level_of(double radius_px);
};

/// A mesh and the scale of the object relative to it.
struct ScaledMesh {
    std::shared_ptr<const ObjectMesh> mesh;
    Eigen::Vector3d scale = Eigen::Vector3d::Ones();
};

/// Sets attributes 0 to 2 of the bound vertex array to the vertices of ShapeMesh in the bound
/// buffer.
void read_corners();

/// Caches meshes by look. A mesh lives as long as an object uses it.
class ObjectMeshes {
public:
    ScaledMesh of(const ObjectLook& look);

private:
    using Key = std::tuple<const ShapeMesh*, ShapeKind, double, double, double>;
    std::shared_ptr<const ObjectMesh> find(const Key& key, const ObjectLook& look);

    std::map<Key, std::weak_ptr<const ObjectMesh>> meshes_;
    std::size_t purge_at_ = 64;
};

}  // namespace atrium::renderer
