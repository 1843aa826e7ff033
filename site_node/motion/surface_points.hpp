#pragma once

#include "core/geometry/triangle_mesh.hpp"

#include <Eigen/Core>

#include <array>
#include <cstdint>
#include <vector>

namespace atrium::motion {

struct SurfacePoint {
    Eigen::Vector3d position;  // [m] site frame
    Eigen::Vector3d normal;    // unit length, outwards
};

/// Points of a surface, ordered by cells of a lattice. Cells are ordered by height.
struct SurfacePoints {
    std::vector<SurfacePoint> points;
    std::vector<std::uint32_t> first_of_cell;  // one per cell, plus the end
    std::vector<Eigen::Vector3d> centres;      // of the points of each cell

    std::size_t num_cells() const { return centres.size(); }

    /// Takes about one point per `sample_m` squared of the surface. Deterministic. Vertices must be
    /// finite. Takes at most kMaxPoints: of larger surfaces fewer per area.
    void assign(const geometry::TriangleMesh& mesh_site, double sample_m, double cell_m);

    static constexpr std::size_t kMaxPoints = 8000;

private:
    struct Placed {
        std::array<std::int32_t, 3> cell;  // z, y, x
        SurfacePoint point;
    };
    std::vector<Placed> placed_;  // scratch
};

}  // namespace atrium::motion
