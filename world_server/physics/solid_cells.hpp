#pragma once

#include "core/geometry/triangle_mesh.hpp"

#include <Eigen/Core>

#include <cstddef>
#include <cstdint>
#include <vector>

namespace atrium::physics {

/// Upper bound of `ConvexPiece::num_points`: one per direction in which extremes are kept.
inline constexpr std::size_t kMaxPointsPerPiece = 26;

/// The convex hull of what a solid has in one cubic cell.
struct ConvexPiece {
    Eigen::Vector3f centre;  // of the cell [m]
    std::uint32_t first_point = 0;
    std::uint32_t num_points = 0;
    std::uint64_t cell = 0;  // names the cell among those of one SolidCells
};

/// A solid cut into convex pieces along a lattice that is fixed in space.
struct SolidCells {
    double cell_m = 0.0;                      // 0: nothing there
    Eigen::Array3i dims;                      // cells along x, y, z
    Eigen::Vector3d origin;                   // lower corner of cell (0, 0, 0)
    std::vector<ConvexPiece> pieces;          // ordered by cell
    std::vector<Eigen::Vector3f> points;      // of all pieces, relative to the centre of the cell
    std::vector<std::int32_t> piece_of_cell;  // -1: empty

    /// The piece in the cell that holds `position`, or -1.
    std::int32_t piece_at(const Eigen::Vector3d& position) const;
};

struct SolidCellsOptions {
    double cell_m = 0.14;
    std::size_t max_pieces = 400;  // with more, the cells are made larger until they are few enough
};

/// Cuts the volume that `mesh` encloses. Each piece spans the extreme points, in 26 directions, of
/// the part of the surface in its cell and of the cell's corners inside the solid; so it lies in
/// the convex hull of the solid within the cell and has all of its extent along these directions.
///
/// The mesh should be closed and oriented outwards; where it is not, cells that its interior fills
/// may be missing, nothing worse. Vertices must be finite and indices in range. Deterministic.
SolidCells cut_into_cells(const geometry::TriangleMesh& mesh, const SolidCellsOptions& options);

}  // namespace atrium::physics
