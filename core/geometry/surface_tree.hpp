#pragma once

#include "core/geometry/triangle_mesh.hpp"

#include <array>
#include <cstdint>
#include <vector>

namespace atrium::geometry {

/// Tells where points are relative to the surface of a mesh, in O(log triangles) for most points.
class SurfaceTree {
public:
    /// The indices of `mesh` must be valid. O(n log n).
    explicit SurfaceTree(const TriangleMesh& mesh);

    bool empty() const { return triangles_.empty(); }
    Aabb box() const { return empty() ? Aabb() : nodes_.front().box; }

    /// Returns the generalised winding number (Jacobson, Kavan, Sorkine-Hornung, "Robust
    /// Inside-Outside Segmentation using Generalized Winding Numbers", 2013): 1 inside a closed
    /// mesh, 0 outside, -1 inside one that faces inwards, a fraction near an open one.
    ///
    /// It is exact for near triangles (van Oosterom, Strackee, 1983). Groups of far ones count as
    /// one dipole (Barill et al., "Fast Winding Numbers for Soups and Clouds", 2018), within 0.05.
    double winding_number(const Eigen::Vector3d& p) const;

    /// Returns the distance to the nearest triangle [m]; infinite if there is none.
    double distance_m(const Eigen::Vector3d& p) const;

    /// Returns the distance to the surface for a point inside (winding number above 0.5), else 0.
    double depth_m(const Eigen::Vector3d& p) const;

private:
    using Corners = std::array<Eigen::Vector3d, 3>;
    struct Node {
        Aabb box;
        std::uint32_t begin = 0, end = 0;  // its triangles
        std::uint32_t second = 0;          // child; the first one is the next node. 0: a leaf
        Eigen::Vector3d area = Eigen::Vector3d::Zero();    // sum of the normals times areas [m^2]
        Eigen::Vector3d centre = Eigen::Vector3d::Zero();  // of the areas
        double radius_m = 0.0;                             // around `centre`
    };
    std::uint32_t add_node(std::uint32_t begin, std::uint32_t end);
    double solid_angle_of(std::uint32_t node, const Eigen::Vector3d& p) const;
    void find_nearest(std::uint32_t node, const Eigen::Vector3d& p, double& nearest_sq) const;

    std::vector<Corners> triangles_;
    std::vector<Node> nodes_;  // the root first
};

}  // namespace atrium::geometry
