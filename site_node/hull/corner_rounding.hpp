#pragma once

#include "core/geometry/triangle_mesh.hpp"
#include "site_node/hull/face_owner.hpp"
#include "site_node/hull/inside_silhouettes.hpp"
#include "site_node/hull/visual_hull.hpp"

#include <Eigen/Core>

#include <array>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

namespace atrium::hull {

struct CornerRoundingOptions {
    /// Smaller moves are not made [m]. A larger one costs about two triangles per viewing edge.
    double least_m = 0.002;
    /// Farther from its corner the body is not assumed to touch a face [m]. Limits the moves where
    /// viewing edges are long because several things hide each other.
    double most_reach_m = 0.08;
};

/// Rounds the corners of a visual hull: a body is smooth, and the hull of few cameras is not.
///
/// Where the cones of two cameras meet, the hull has a corner outside of every smooth body with
/// the same silhouettes. What is known: the body touches each viewing edge at least once.
/// Assumption: in its middle, and it curves evenly from there to the middle on the other side of
/// the corner. Let two faces meet at an outer angle of phi, and let the nearer of the two middles
/// be s away; a circle that touches both there passes the corner at a distance of s tan(phi / 4).
/// By this much the corner moves inwards, along the mean of the faces' normals. The middles of the
/// viewing edges stay where they are, so the silhouettes stay, too.
///
/// Concave corners stay, and so do those at faces of no camera, such as the bounds. Related:
/// Furukawa, Ponce (2006), "Carved Visual Hulls for Image-Based Modeling", find where the body
/// touches the hull ("rims") from the pictures; here that is assumed.
///
/// Keeps its memory. Deterministic. Not thread-safe.
class CornerRounding {
public:
    explicit CornerRounding(const CornerRoundingOptions& options = {}) : options_(options) {}

    /// Rounds `mesh`, the hull of `views` or some of its components, in place. Null views are
    /// skipped. The result is a closed 2-manifold with the same components, and all of its vertices
    /// are inside the hull. False, and nothing changes, if the mesh is no closed 2-manifold.
    bool round(geometry::TriangleMesh& mesh, std::span<const SilhouetteView* const> views);

private:
    static constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();
    static constexpr std::int32_t kNobody = kNoOwner;

    struct Face {
        Eigen::Vector3d normal;  // unit; zero without area
        double doubled_area_m2 = 0.0;
        std::int32_t owner = kNobody;  // camera whose outline made it
    };
    struct Edge {
        std::uint32_t a = 0;  // a < b
        std::uint32_t b = 0;
        std::array<std::uint32_t, 2> faces{kNone, kNone};
        bool first_leaves_a = false;  // the first face has it from a to b
    };
    // A camera whose faces meet at a corner.
    struct Meeting {
        std::int32_t camera = kNobody;
        Eigen::Vector3d normal = Eigen::Vector3d::Zero();
        double reach_m = -1.0;  // from the corner to the middle of its viewing edge; < 0: unknown
    };
    // In general position three faces meet at a vertex.
    struct Corner {
        std::array<Meeting, 4> meetings;
        std::uint32_t num = 0;
        bool stays = false;

        Meeting* of(std::int32_t camera);
    };

    bool join_edges(const geometry::TriangleMesh& mesh);
    void find_owners(const geometry::TriangleMesh& mesh);
    bool is_viewing_edge(std::uint32_t a,
                         std::uint32_t b,
                         std::int32_t camera,
                         const geometry::TriangleMesh& mesh) const;
    void find_corners(const geometry::TriangleMesh& mesh);
    void guess_reaches();
    void find_moves(const geometry::TriangleMesh& mesh);
    void smooth_moves();
    void split_viewing_edges(geometry::TriangleMesh& mesh);
    static std::uint32_t after(std::uint32_t half_edge) {
        return half_edge % 3 == 2 ? half_edge - 2 : half_edge + 1;
    }
    static std::uint32_t before(std::uint32_t half_edge) {
        return half_edge % 3 == 0 ? half_edge + 2 : half_edge - 1;
    }
    void find_twins(const geometry::TriangleMesh& mesh);
    bool is_joined(std::uint32_t half_edge,
                   std::uint32_t corner,
                   const geometry::TriangleMesh& mesh) const;
    void exchange_diagonals(geometry::TriangleMesh& mesh);
    void move_corners(geometry::TriangleMesh& mesh, std::span<const SilhouetteView* const> views);
    bool exchange(std::uint32_t half_edge, geometry::TriangleMesh& mesh);

    CornerRoundingOptions options_;
    InsideSilhouettes inside_;
    std::vector<Eigen::Vector3d> centres_site_;
    std::vector<Face> faces_;
    std::vector<Edge> edges_;
    std::vector<std::array<std::uint32_t, 3>> edges_of_face_;  // edge k joins corners k and k + 1
    std::vector<std::uint32_t> first_edge_;                    // per vertex a: of its edges
    std::vector<std::uint8_t> is_viewing_;                     // per edge
    std::vector<Corner> corners_;
    std::vector<double> moves_m_;  // per vertex
    std::vector<double> before_m_;
    std::vector<std::uint32_t> num_summed_;
    std::vector<std::array<double, 4>> reach_sums_;
    std::vector<std::array<std::uint32_t, 4>> reach_counts_;
    std::vector<Eigen::Vector3d> inwards_;  // per vertex
    std::vector<std::uint32_t> middles_;    // per edge: vertex
    std::vector<std::int32_t> owners_;      // per triangle of the result
    std::vector<std::array<std::uint32_t, 3>> triangles_;
    std::vector<std::uint32_t> twins_;  // per half-edge
    struct HalfEdge {
        std::uint32_t other = 0;
        std::uint32_t face = 0;
        std::uint32_t side = 0;
        bool leaves_low = false;
    };
    std::vector<HalfEdge> half_edges_;
    std::vector<std::uint32_t> first_half_;
};

}  // namespace atrium::hull
