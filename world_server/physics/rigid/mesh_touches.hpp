#pragma once

#include "world_server/physics/rigid/flat_face.hpp"

#include <btBulletCollisionCommon.h>

#include <array>
#include <cstddef>
#include <optional>
#include <vector>

namespace atrium::physics {

struct MeshTriangle {
    std::array<btVector3, 3> corners;
    int part = 0;
    int index = 0;
};

/// Finds where a cylinder, box or hull lies flat on triangles of a mesh. Triangles in one plane are
/// one face, however the mesh divides it.
class MeshTouches {
public:
    static constexpr std::size_t kMaxFaces = 3;  // as in the corner of a room

    explicit MeshTouches(const FlatContactOptions& options) : options_(options) {}

    /// Starts anew with a shape, its pose in the mesh, and the distance up to which it touches.
    void begin(const btConvexShape& shape, const btTransform& mesh_from_shape, btScalar reach_m);
    /// Adds a triangle in the mesh's frame. It is solid on both sides.
    void add(const MeshTriangle& triangle);
    /// Finds the touches. After that `others` has the triangles that may touch the shape elsewhere.
    void finish();

    const std::vector<FlatTouch>& touches() const { return touches_; }  // in the mesh's frame
    const std::vector<MeshTriangle>& others() const { return others_; }

private:
    struct Face {
        FlatArea area;
        FlatFace foot;  // the face of the shape
    };
    struct Side {  // of a triangle: a plane that looks at the shape
        btVector3 normal;
        btVector3 origin;
    };
    Face* face_at(const Side& side);
    const std::optional<FlatFace>& foot_towards(const btVector3& direction);

    const FlatContactOptions& options_;
    const btConvexShape* shape_ = nullptr;
    btTransform mesh_from_shape_;
    btScalar reach_m_ = 0;
    std::vector<Face> faces_;
    struct FlatTriangle {
        MeshTriangle triangle;
        std::size_t face;  // in faces_
    };
    std::vector<FlatTriangle> flat_;
    std::vector<MeshTriangle> others_;
    std::vector<FlatTouch> touches_;
    btVector3 last_direction_{0, 0, 0};  // of last_foot_
    std::optional<FlatFace> last_foot_;
};

}  // namespace atrium::physics
