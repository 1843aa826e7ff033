#include "world_server/physics/solid_cells.hpp"

#include "core/geometry/aabb.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <limits>
#include <utility>

namespace atrium::physics {
namespace {

constexpr double kMaxCells = 200'000.0;
// Bounds the work that a mesh of many room-sized triangles can ask for.
constexpr double kMaxFragments = 200'000.0;
// The lattice stands askew to round numbers, so that faces made at them do not lie in its planes.
constexpr double kLatticeOffsetM = 0.01234567;

using Polygon = std::vector<Eigen::Vector3d>;

std::array<Eigen::Vector3f, kMaxPointsPerPiece> extreme_directions() {
    std::array<Eigen::Vector3f, kMaxPointsPerPiece> directions;
    std::size_t n = 0;
    for (int x = -1; x <= 1; ++x) {
        for (int y = -1; y <= 1; ++y) {
            for (int z = -1; z <= 1; ++z) {
                if (x != 0 || y != 0 || z != 0)
                    directions[n++] = Eigen::Vector3i(x, y, z).cast<float>();
            }
        }
    }
    return directions;
}

// The extreme points met so far of one cell.
struct Extremes {
    std::array<float, kMaxPointsPerPiece> reach;
    std::array<Eigen::Vector3f, kMaxPointsPerPiece> point;
};

struct Crossing {
    int column;
    double z;
    int step;  // +1: the solid begins above, -1: it ends
    bool operator<(const Crossing& other) const {
        return std::pair(column, z) < std::pair(other.column, other.z);
    }
};

// > 0 when p lies left of the line from a to b; the same number, negated, for b to a.
double left_of(const Eigen::Vector3d& a, const Eigen::Vector3d& b, double x, double y) {
    const bool swapped = std::pair(b.x(), b.y()) < std::pair(a.x(), a.y());
    const Eigen::Vector3d& from = swapped ? b : a;
    const Eigen::Vector3d& to = swapped ? a : b;
    double side = (to.x() - from.x()) * (y - from.y()) - (to.y() - from.y()) * (x - from.x());
    if (side == 0.0) side = std::numeric_limits<double>::min();  // on the line: to one side, always
    return swapped ? -side : side;
}

class Cutter {
public:
    Cutter(const geometry::TriangleMesh& mesh, double cell_m);
    bool fits() const { return fits_; }
    SolidCells cut();

private:
    int cell_along(int axis, double value) const {
        const int cell =
            static_cast<int>(std::floor((value - cells_.origin[axis]) / cells_.cell_m));
        return std::clamp(cell, 0, cells_.dims[axis] - 1);
    }
    Eigen::Array3i cell_at(const Eigen::Vector3d& p) const {
        return {cell_along(0, p.x()), cell_along(1, p.y()), cell_along(2, p.z())};
    }
    void add_point(const Eigen::Array3i& cell, const Eigen::Vector3d& p);
    void split_and_add(Polygon polygon, int axis);
    void add_surface();
    void collect_crossings(const std::array<std::uint32_t, 3>& triangle);
    void add_inside_corners();
    void add_corner(int x, int y, int z);
    SolidCells finish();

    const geometry::TriangleMesh& mesh_;
    SolidCells cells_;
    std::array<Eigen::Vector3f, kMaxPointsPerPiece> directions_ = extreme_directions();
    std::vector<Extremes> extremes_;  // one per piece, in order of discovery
    std::vector<Crossing> crossings_;
    bool fits_ = false;
};

Cutter::Cutter(const geometry::TriangleMesh& mesh, double cell_m) : mesh_(mesh) {
    geometry::Aabb box;
    for (const auto& t : mesh.triangles) {
        for (const std::uint32_t v : t) box.add(mesh.vertices[v]);
    }
    if (box.empty()) return;
    const auto lattice_floor = [&](double value) {
        return std::floor((value - kLatticeOffsetM) / cell_m);
    };
    const Eigen::Array3d low = box.min.array().unaryExpr(lattice_floor);
    const Eigen::Array3d high = box.max.array().unaryExpr(lattice_floor);
    const Eigen::Array3d dims = high - low + 1.0;
    if (dims.prod() > kMaxCells) return;
    double num_fragments = 0.0;
    for (const auto& t : mesh.triangles) {
        geometry::Aabb extent;
        for (const std::uint32_t v : t) extent.add(mesh.vertices[v]);
        num_fragments += (extent.size() / cell_m).array().ceil().max(1.0).prod();
    }
    if (num_fragments > kMaxFragments + 4.0 * static_cast<double>(mesh.triangles.size())) return;
    fits_ = true;
    cells_.cell_m = cell_m;
    cells_.dims = dims.cast<int>();
    cells_.origin = (low * cell_m + kLatticeOffsetM).matrix();
    cells_.piece_of_cell.assign(static_cast<std::size_t>(cells_.dims.prod()), -1);
}

void Cutter::add_point(const Eigen::Array3i& cell, const Eigen::Vector3d& p) {
    const auto index = static_cast<std::size_t>(
        (cell.z() * cells_.dims.y() + cell.y()) * cells_.dims.x() + cell.x());
    const Eigen::Vector3d centre =
        cells_.origin + cells_.cell_m * (cell.cast<double>() + 0.5).matrix();
    const Eigen::Vector3f offset = (p - centre).cast<float>();
    std::int32_t& piece = cells_.piece_of_cell[index];
    if (piece < 0) {
        piece = static_cast<std::int32_t>(extremes_.size());
        extremes_.emplace_back().reach.fill(-std::numeric_limits<float>::infinity());
        cells_.pieces.push_back({centre.cast<float>(), 0, 0, index});
    }
    Extremes& extremes = extremes_[static_cast<std::size_t>(piece)];
    for (std::size_t d = 0; d < directions_.size(); ++d) {
        const float reach = directions_[d].dot(offset);
        if (reach > extremes.reach[d]) {
            extremes.reach[d] = reach;
            extremes.point[d] = offset;
        }
    }
}

// Cuts the polygon along the lattice's planes across `axis`, the parts along those of the next.
void Cutter::split_and_add(Polygon polygon, int axis) {
    if (axis == 3) {
        Eigen::Vector3d middle = Eigen::Vector3d::Zero();
        for (const Eigen::Vector3d& p : polygon) middle += p;
        const Eigen::Array3i cell = cell_at(middle / static_cast<double>(polygon.size()));
        for (const Eigen::Vector3d& p : polygon) add_point(cell, p);
        return;
    }
    const auto [low, high] =
        std::minmax_element(polygon.begin(), polygon.end(), [&](const auto& a, const auto& b) {
            return a[axis] < b[axis];
        });
    const int first = cell_along(axis, (*low)[axis]);
    const int last = cell_along(axis, (*high)[axis]);
    for (int cell = first; cell < last && !polygon.empty(); ++cell) {
        const double plane = cells_.origin[axis] + cells_.cell_m * (cell + 1);
        Polygon below;
        Polygon above;
        for (std::size_t i = 0; i < polygon.size(); ++i) {
            const Eigen::Vector3d& a = polygon[i];
            const Eigen::Vector3d& b = polygon[(i + 1) % polygon.size()];
            (a[axis] < plane ? below : above).push_back(a);
            if ((a[axis] < plane) != (b[axis] < plane)) {
                Eigen::Vector3d cut = a + (plane - a[axis]) / (b[axis] - a[axis]) * (b - a);
                cut[axis] = plane;
                below.push_back(cut);
                above.push_back(cut);
            }
        }
        if (!below.empty()) split_and_add(std::move(below), axis + 1);
        polygon = std::move(above);
    }
    if (!polygon.empty()) split_and_add(std::move(polygon), axis + 1);
}

void Cutter::add_surface() {
    std::vector<Eigen::Array3i> cell_of_vertex(mesh_.vertices.size());
    for (std::size_t v = 0; v < mesh_.vertices.size(); ++v) {
        cell_of_vertex[v] = cell_at(mesh_.vertices[v]);
    }
    std::vector<bool> added(mesh_.vertices.size(), false);
    for (const auto& t : mesh_.triangles) {
        for (const std::uint32_t v : t) {
            if (!added[v]) add_point(cell_of_vertex[v], mesh_.vertices[v]);
            added[v] = true;
        }
        const Eigen::Array3i& first = cell_of_vertex[t[0]];
        if ((first == cell_of_vertex[t[1]]).all() && (first == cell_of_vertex[t[2]]).all())
            continue;
        split_and_add({mesh_.vertices[t[0]], mesh_.vertices[t[1]], mesh_.vertices[t[2]]}, 0);
    }
}

// Where the vertical lines through the lattice's corners pass the triangle.
void Cutter::collect_crossings(const std::array<std::uint32_t, 3>& triangle) {
    const Eigen::Vector3d& a = mesh_.vertices[triangle[0]];
    const Eigen::Vector3d& b = mesh_.vertices[triangle[1]];
    const Eigen::Vector3d& c = mesh_.vertices[triangle[2]];
    const double doubled_area =
        (b.x() - a.x()) * (c.y() - a.y()) - (b.y() - a.y()) * (c.x() - a.x());
    if (doubled_area == 0.0) return;
    const auto [x_min, x_max] = std::minmax({a.x(), b.x(), c.x()});
    const auto [y_min, y_max] = std::minmax({a.y(), b.y(), c.y()});
    const int width = cells_.dims.x() + 1;
    for (int j = cell_along(1, y_min); j <= cell_along(1, y_max) + 1; ++j) {
        const double y = cells_.origin.y() + cells_.cell_m * j;
        if (y < y_min || y > y_max) continue;
        for (int i = cell_along(0, x_min); i <= cell_along(0, x_max) + 1; ++i) {
            const double x = cells_.origin.x() + cells_.cell_m * i;
            const double at_a = left_of(b, c, x, y);
            const double at_b = left_of(c, a, x, y);
            const double at_c = left_of(a, b, x, y);
            const bool up = at_a > 0.0 && at_b > 0.0 && at_c > 0.0;
            const bool down = at_a < 0.0 && at_b < 0.0 && at_c < 0.0;
            if (!up && !down) continue;
            const double z = (at_a * a.z() + at_b * b.z() + at_c * c.z()) / (at_a + at_b + at_c);
            crossings_.push_back({j * width + i, z, up ? -1 : 1});
        }
    }
}

void Cutter::add_corner(int x, int y, int z) {
    const Eigen::Vector3d corner =
        cells_.origin + cells_.cell_m * Eigen::Vector3i(x, y, z).cast<double>();
    for (int neighbour = 0; neighbour < 8; ++neighbour) {
        const Eigen::Array3i cell(
            x - (neighbour & 1), y - (neighbour >> 1 & 1), z - (neighbour >> 2 & 1));
        if ((cell >= 0).all() && (cell < cells_.dims).all()) add_point(cell, corner);
    }
}

void Cutter::add_inside_corners() {
    for (const auto& t : mesh_.triangles) collect_crossings(t);
    std::sort(crossings_.begin(), crossings_.end());
    const int width = cells_.dims.x() + 1;
    for (std::size_t begin = 0; begin < crossings_.size();) {
        // one column; a surface with a hole above or below it does not say where its inside ends
        std::size_t end = begin;
        int sum = 0;
        for (; end < crossings_.size() && crossings_[end].column == crossings_[begin].column;
             ++end) {
            sum += crossings_[end].step;
        }
        int depth = 0;
        for (std::size_t i = begin; sum == 0 && i + 1 < end; ++i) {
            depth += crossings_[i].step;
            if (depth <= 0) continue;
            const int column = crossings_[i].column;
            const double low = (crossings_[i].z - cells_.origin.z()) / cells_.cell_m;
            const double high = (crossings_[i + 1].z - cells_.origin.z()) / cells_.cell_m;
            for (int z = static_cast<int>(std::ceil(low)); z <= std::floor(high); ++z) {
                add_corner(column % width, column / width, z);
            }
        }
        begin = end;
    }
}

SolidCells Cutter::finish() {
    // order by cell, so that the result does not depend on the order of the triangles
    std::vector<std::size_t> order(cells_.pieces.size());
    for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
    std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
        return cells_.pieces[a].cell < cells_.pieces[b].cell;
    });
    std::vector<ConvexPiece> sorted;
    sorted.reserve(order.size());
    for (const std::size_t i : order) {
        ConvexPiece piece = cells_.pieces[i];
        piece.first_point = static_cast<std::uint32_t>(cells_.points.size());
        for (const Eigen::Vector3f& point : extremes_[i].point) {
            const auto begin = cells_.points.begin() + piece.first_point;
            if (std::find(begin, cells_.points.end(), point) == cells_.points.end()) {
                cells_.points.push_back(point);
            }
        }
        piece.num_points = static_cast<std::uint32_t>(cells_.points.size()) - piece.first_point;
        cells_.piece_of_cell[piece.cell] = static_cast<std::int32_t>(sorted.size());
        sorted.push_back(piece);
    }
    cells_.pieces = std::move(sorted);
    return std::move(cells_);
}

SolidCells Cutter::cut() {
    add_surface();
    add_inside_corners();
    return finish();
}

}  // namespace

std::int32_t SolidCells::piece_at(const Eigen::Vector3d& position) const {
    if (pieces.empty()) return -1;
    const Eigen::Array3d cell = ((position - origin) / cell_m).array().floor();
    if (!(cell >= 0.0).all() || !(cell < dims.cast<double>()).all()) return -1;
    const Eigen::Array3i c = cell.cast<int>();
    return piece_of_cell[static_cast<std::size_t>((c.z() * dims.y() + c.y()) * dims.x() + c.x())];
}

SolidCells cut_into_cells(const geometry::TriangleMesh& mesh, const SolidCellsOptions& options) {
    assert(options.cell_m > 0.0 && options.max_pieces > 0);
    if (mesh.empty()) return {};
    for (double cell_m = options.cell_m;; cell_m *= 1.25) {
        Cutter cutter(mesh, cell_m);
        if (!cutter.fits()) continue;
        SolidCells cells = cutter.cut();
        if (cells.pieces.size() <= options.max_pieces) return cells;
    }
}

}  // namespace atrium::physics
