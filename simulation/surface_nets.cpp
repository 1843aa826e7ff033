#include "simulation/surface_nets.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>

namespace atrium::simulation {
namespace {

constexpr std::uint32_t kNoVertex = 0xffffffffu;

// Samples at the cell corners; index = x + nx * (y + ny * z).
struct Grid {
    std::array<int, 3> num{};
    Eigen::Vector3d origin;
    double cell_m = 0.0;
    std::vector<double> values;

    std::size_t index(int x, int y, int z) const {
        return static_cast<std::size_t>(x) +
               static_cast<std::size_t>(num[0]) *
                   (static_cast<std::size_t>(y) +
                    static_cast<std::size_t>(num[1]) * static_cast<std::size_t>(z));
    }
    bool inside(int x, int y, int z) const { return values[index(x, y, z)] < 0.0; }
};

Grid sample(const DistanceField& distance, const geometry::Aabb& box, double cell_m) {
    Grid grid;
    grid.cell_m = cell_m;
    grid.origin = box.min;
    const Eigen::Vector3d size = box.size();
    for (int axis = 0; axis < 3; ++axis) {
        grid.num[static_cast<std::size_t>(axis)] =
            static_cast<int>(std::ceil(size[axis] / cell_m)) + 1;
    }
    grid.values.resize(grid.index(0, 0, grid.num[2]));
    // far from the surface one value serves a whole block; the factor allows for inexact distances
    constexpr int kBlock = 5;
    const double safe_m = 2.0 * 0.5 * std::sqrt(3.0) * (kBlock - 1) * cell_m + cell_m;
    for (int z0 = 0; z0 < grid.num[2]; z0 += kBlock) {
        for (int y0 = 0; y0 < grid.num[1]; y0 += kBlock) {
            for (int x0 = 0; x0 < grid.num[0]; x0 += kBlock) {
                const Eigen::Vector3d centre =
                    Eigen::Vector3d(x0, y0, z0).array() + 0.5 * (kBlock - 1);
                const double at_centre = distance(grid.origin + cell_m * centre);
                const bool near = std::abs(at_centre) < safe_m;
                for (int z = z0; z < std::min(z0 + kBlock, grid.num[2]); ++z) {
                    for (int y = y0; y < std::min(y0 + kBlock, grid.num[1]); ++y) {
                        for (int x = x0; x < std::min(x0 + kBlock, grid.num[0]); ++x) {
                            const Eigen::Vector3d p =
                                grid.origin + cell_m * Eigen::Vector3d(x, y, z);
                            grid.values[grid.index(x, y, z)] = near ? distance(p) : at_centre;
                        }
                    }
                }
            }
        }
    }
    return grid;
}

// Returns true if the corners of a cell on one side (bits of `corners`) are connected along the
// cell's edges.
bool connected(unsigned corners) {
    if (corners == 0) return true;
    unsigned reached = corners & (~corners + 1);
    for (int step = 0; step < 7; ++step) {
        const unsigned x = ((reached & 0x55) << 1) | ((reached & 0xaa) >> 1);
        const unsigned y = ((reached & 0x33) << 2) | ((reached & 0xcc) >> 2);
        const unsigned z = ((reached & 0x0f) << 4) | ((reached & 0xf0) >> 4);
        reached |= (x | y | z) & corners;
    }
    return reached == corners;
}

// A face with inside and outside on crossing diagonals would create an edge with four triangles.
bool has_crossed_face(unsigned corners) {
    constexpr std::array<std::array<unsigned, 4>, 6> kFaces = {
        {{0, 1, 3, 2}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 3, 7, 6}, {0, 2, 6, 4}, {1, 3, 7, 5}}};
    for (const auto& face : kFaces) {
        const auto at = [&](std::size_t i) { return (corners >> face[i]) & 1u; };
        if (at(0) == at(2) && at(1) == at(3) && at(0) != at(1)) return true;
    }
    return false;
}

// Fills a corner of every cell in which the surface would touch itself, until none is left: the
// mesh is then 2-manifold.
void fill_touching_cells(Grid& grid) {
    bool changed = true;
    while (changed) {
        changed = false;
        for (int z = 0; z + 1 < grid.num[2]; ++z) {
            for (int y = 0; y + 1 < grid.num[1]; ++y) {
                for (int x = 0; x + 1 < grid.num[0]; ++x) {
                    unsigned inside = 0;
                    std::size_t lowest_outside = grid.values.size();
                    for (unsigned corner = 0; corner < 8; ++corner) {
                        const std::size_t i = grid.index(x + static_cast<int>(corner & 1),
                                                         y + static_cast<int>((corner >> 1) & 1),
                                                         z + static_cast<int>(corner >> 2));
                        if (grid.values[i] < 0.0) {
                            inside |= 1u << corner;
                        } else if (lowest_outside == grid.values.size() ||
                                   grid.values[i] < grid.values[lowest_outside]) {
                            lowest_outside = i;
                        }
                    }
                    if (inside == 0 || inside == 0xff) continue;
                    if (connected(inside) && connected(~inside & 0xff) && !has_crossed_face(inside))
                        continue;
                    grid.values[lowest_outside] = -0.05 * grid.cell_m;
                    changed = true;
                }
            }
        }
    }
}

// Computes the mean of the crossings on the edges of the cell at (x, y, z). Returns false without
// any.
bool cell_vertex(const Grid& grid, int x, int y, int z, Eigen::Vector3d& vertex) {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    int num_crossings = 0;
    for (int corner = 0; corner < 8; ++corner) {
        const std::array<int, 3> a = {x + (corner & 1), y + ((corner >> 1) & 1), z + (corner >> 2)};
        const double value_a = grid.values[grid.index(a[0], a[1], a[2])];
        for (std::size_t axis = 0; axis < 3; ++axis) {
            if ((corner >> axis) & 1) continue;
            std::array<int, 3> b = a;
            ++b[axis];
            const double value_b = grid.values[grid.index(b[0], b[1], b[2])];
            if ((value_a < 0.0) == (value_b < 0.0)) continue;
            Eigen::Vector3d crossing(a[0], a[1], a[2]);
            crossing[static_cast<int>(axis)] += value_a / (value_a - value_b);
            sum += crossing;
            ++num_crossings;
        }
    }
    if (num_crossings == 0) return false;
    vertex = grid.origin + grid.cell_m * sum / num_crossings;
    return true;
}

// Adds the quad of the four cells around the grid edge from (x, y, z) along `axis`, if the surface
// crosses it.
void add_quad(const Grid& grid,
              const std::vector<std::uint32_t>& vertex_of_cell,
              const std::array<int, 3>& at,
              std::size_t axis,
              geometry::TriangleMesh& mesh) {
    std::array<int, 3> end = at;
    ++end[axis];
    const bool starts_inside = grid.inside(at[0], at[1], at[2]);
    if (starts_inside == grid.inside(end[0], end[1], end[2])) return;
    const std::size_t u = (axis + 1) % 3;
    const std::size_t v = (axis + 2) % 3;
    std::array<std::uint32_t, 4> quad{};
    constexpr std::array<std::array<int, 2>, 4> kRound = {{{-1, -1}, {0, -1}, {0, 0}, {-1, 0}}};
    for (std::size_t i = 0; i < 4; ++i) {
        std::array<int, 3> cell = at;
        cell[u] += kRound[i][0];
        cell[v] += kRound[i][1];
        quad[i] = vertex_of_cell[grid.index(cell[0], cell[1], cell[2])];
        assert(quad[i] != kNoVertex);
    }
    if (!starts_inside) std::swap(quad[1], quad[3]);
    // the shorter diagonal bends less
    const auto& p = mesh.vertices;
    if ((p[quad[0]] - p[quad[2]]).squaredNorm() <= (p[quad[1]] - p[quad[3]]).squaredNorm()) {
        mesh.triangles.push_back({quad[0], quad[1], quad[2]});
        mesh.triangles.push_back({quad[0], quad[2], quad[3]});
    } else {
        mesh.triangles.push_back({quad[0], quad[1], quad[3]});
        mesh.triangles.push_back({quad[1], quad[2], quad[3]});
    }
}

}  // namespace

Eigen::Vector3d gradient_direction(const DistanceField& distance,
                                   const Eigen::Vector3d& p,
                                   double step_m) {
    Eigen::Vector3d gradient;
    for (int axis = 0; axis < 3; ++axis) {
        Eigen::Vector3d step = Eigen::Vector3d::Zero();
        step[axis] = step_m;
        gradient[axis] = distance(p + step) - distance(p - step);
    }
    const double norm = gradient.norm();
    return norm > 0.0 ? Eigen::Vector3d(gradient / norm) : Eigen::Vector3d::UnitZ();
}

geometry::TriangleMesh surface_nets(const DistanceField& distance,
                                    const geometry::Aabb& box,
                                    double cell_m) {
    assert(cell_m > 0.0 && !box.empty());
    Grid grid = sample(distance, box, cell_m);
    fill_touching_cells(grid);
    geometry::TriangleMesh mesh;
    std::vector<std::uint32_t> vertex_of_cell(grid.values.size(), kNoVertex);
    for (int z = 0; z + 1 < grid.num[2]; ++z) {
        for (int y = 0; y + 1 < grid.num[1]; ++y) {
            for (int x = 0; x + 1 < grid.num[0]; ++x) {
                Eigen::Vector3d vertex;
                if (!cell_vertex(grid, x, y, z, vertex)) continue;
                vertex_of_cell[grid.index(x, y, z)] =
                    static_cast<std::uint32_t>(mesh.vertices.size());
                mesh.vertices.push_back(vertex);
            }
        }
    }
    for (Eigen::Vector3d& vertex : mesh.vertices) {
        const Eigen::Vector3d outwards = gradient_direction(distance, vertex, 0.25 * cell_m);
        // at most half a cell: an inexact field must not move a vertex past its neighbours
        vertex -= std::clamp(distance(vertex), -0.5 * cell_m, 0.5 * cell_m) * outwards;
    }
    for (int z = 1; z + 1 < grid.num[2]; ++z) {
        for (int y = 1; y + 1 < grid.num[1]; ++y) {
            for (int x = 1; x + 1 < grid.num[0]; ++x) {
                for (std::size_t axis = 0; axis < 3; ++axis)
                    add_quad(grid, vertex_of_cell, {x, y, z}, axis, mesh);
            }
        }
    }
    return mesh;
}

}  // namespace atrium::simulation
