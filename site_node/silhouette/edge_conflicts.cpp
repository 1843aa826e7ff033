#include "site_node/silhouette/edge_conflicts.hpp"

#include <algorithm>
#include <cmath>

namespace atrium::silhouette {
namespace {

constexpr double kMinCellPx = 12.0;  // a few edges per cell; typical edges are 5 to 30 px long
constexpr int kMaxCells = 128;       // per side

struct Edge {
    Eigen::Vector2d a;
    Eigen::Vector2d b;
};

Edge edge_of(const SilhouettePolygon& polygon, std::uint32_t k) {
    return {polygon.vertices_px[k],
            polygon.vertices_px[k + 1 < polygon.vertices_px.size() ? k + 1 : 0]};
}

double turn(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Eigen::Vector2d& c) {
    return (b.x() - a.x()) * (c.y() - a.y()) - (b.y() - a.y()) * (c.x() - a.x());
}

// Side of `line` on which p lies; 0 also where rounding could change the sign (coordinates of some
// thousand pixels).
int side(const Edge& line, const Eigen::Vector2d& p) {
    constexpr double kRounding = 1e-7;
    const double t = turn(line.a, line.b, p);
    return t > kRounding ? 1 : (t < -kRounding ? -1 : 0);
}

bool boxes_apart(const Edge& s, const Edge& t) {
    return std::max(s.a.x(), s.b.x()) < std::min(t.a.x(), t.b.x()) ||
           std::max(t.a.x(), t.b.x()) < std::min(s.a.x(), s.b.x()) ||
           std::max(s.a.y(), s.b.y()) < std::min(t.a.y(), t.b.y()) ||
           std::max(t.a.y(), t.b.y()) < std::min(s.a.y(), s.b.y());
}

bool meet(const Edge& s, const Edge& t) {
    if (boxes_apart(s, t)) return false;
    return side(s, t.a) * side(s, t.b) <= 0 && side(t, s.a) * side(t, s.b) <= 0;
}

// `first` ends where `second` begins: they may meet only there.
bool folds_back(const Edge& first, const Edge& second) {
    return side(first, second.b) == 0 && (first.b - first.a).dot(second.b - second.a) <= 0.0;
}

bool conflict(std::span<const SilhouettePolygon> polygons, EdgeConflict s, EdgeConflict t) {
    const Edge a = edge_of(polygons[s.polygon], s.edge);
    const Edge b = edge_of(polygons[t.polygon], t.edge);
    if (s.polygon == t.polygon) {
        if (s.edge == t.edge) return false;
        const auto n = static_cast<std::uint32_t>(polygons[s.polygon].vertices_px.size());
        const bool t_follows = (s.edge + 1) % n == t.edge;
        const bool s_follows = (t.edge + 1) % n == s.edge;
        if (t_follows && folds_back(a, b)) return true;
        if (s_follows && folds_back(b, a)) return true;
        if (t_follows || s_follows) return false;
    }
    return meet(a, b);
}

struct GridFrame {
    Eigen::Vector2d origin_px = Eigen::Vector2d::Zero();
    double cells_per_px = 0.0;
    int columns = 1;
    int rows = 1;

    int column(double x) const {
        return std::clamp(static_cast<int>((x - origin_px.x()) * cells_per_px), 0, columns - 1);
    }
    int row(double y) const {
        return std::clamp(static_cast<int>((y - origin_px.y()) * cells_per_px), 0, rows - 1);
    }
};

GridFrame frame_around(std::span<const SilhouettePolygon> polygons) {
    Eigen::Array2d low = Eigen::Array2d::Constant(1e30);
    Eigen::Array2d high = Eigen::Array2d::Constant(-1e30);
    for (const SilhouettePolygon& polygon : polygons) {
        for (const Eigen::Vector2d& p : polygon.vertices_px) {
            low = low.min(p.array());
            high = high.max(p.array());
        }
    }
    GridFrame frame;
    if ((low > high).any()) return frame;
    const Eigen::Array2d size = high - low;
    const double cell_px = std::max(kMinCellPx, size.maxCoeff() / kMaxCells);
    frame.origin_px = low;
    frame.cells_per_px = 1.0 / cell_px;
    frame.columns = 1 + static_cast<int>(size.x() / cell_px);
    frame.rows = 1 + static_cast<int>(size.y() / cell_px);
    return frame;
}

}  // namespace

void find_conflicts(std::span<const SilhouettePolygon> polygons,
                    EdgeGrid& grid,
                    std::vector<EdgeConflict>& out) {
    out.clear();
    const GridFrame frame = frame_around(polygons);
    grid.cells.assign(
        static_cast<std::size_t>(frame.columns) * static_cast<std::size_t>(frame.rows), -1);
    grid.entries.clear();
    const auto visit_cell = [&](std::int32_t& head, EdgeConflict edge) {
        for (std::int32_t i = head; i >= 0; i = grid.entries[static_cast<std::size_t>(i)].next) {
            const EdgeGrid::Entry& other = grid.entries[static_cast<std::size_t>(i)];
            if (!conflict(polygons, edge, {other.polygon, other.edge})) continue;
            out.push_back(edge);
            out.push_back({other.polygon, other.edge});
        }
        grid.entries.push_back({edge.polygon, edge.edge, head});
        head = static_cast<std::int32_t>(grid.entries.size()) - 1;
    };
    for (std::uint32_t p = 0; p < polygons.size(); ++p) {
        const auto n = static_cast<std::uint32_t>(polygons[p].vertices_px.size());
        for (std::uint32_t k = 0; k < n; ++k) {
            const Edge edge = edge_of(polygons[p], k);
            if (edge.a == edge.b) out.push_back({p, k});
            const int last_row = frame.row(std::max(edge.a.y(), edge.b.y()));
            const int last_column = frame.column(std::max(edge.a.x(), edge.b.x()));
            for (int row = frame.row(std::min(edge.a.y(), edge.b.y())); row <= last_row; ++row) {
                for (int column = frame.column(std::min(edge.a.x(), edge.b.x()));
                     column <= last_column;
                     ++column) {
                    visit_cell(grid.cells[static_cast<std::size_t>(row * frame.columns + column)],
                               {p, k});
                }
            }
        }
    }
}

}  // namespace atrium::silhouette
