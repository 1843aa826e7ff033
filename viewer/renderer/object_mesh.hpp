#pragma once

#include "core/gl/resources.hpp"
#include "viewer/renderer/object_look.hpp"

#include <array>
#include <cstddef>
#include <map>
#include <memory>
#include <tuple>

namespace atrium::renderer {

/// A mesh in GL's memory, of all things that look like it.
struct ObjectMesh {
    struct Level {
        std::size_t first = 0;  // in `indices`
        int num_indices = 0;
    };

    gl::VertexArray layout;
    gl::Buffer corners;
    gl::Buffer indices;
    std::array<Level, 3> levels;  // ever fewer triangles
    Eigen::Vector3d half_extent = Eigen::Vector3d::Zero();

    /// Number of the one with as many triangles as make no difference where it is `radius_px`
    /// large.
    static std::size_t level_of(double radius_px);
};

/// A mesh, and how much larger a thing is than it.
struct ScaledMesh {
    std::shared_ptr<const ObjectMesh> mesh;
    Eigen::Vector3d scale = Eigen::Vector3d::Ones();
};

/// The corners of ShapeMesh, from the bound buffer for the bound vertex array: attributes 0 to 2.
void read_corners();

/// Meshes by what they show; kept as long as something looks like them.
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
