#include "site_node/hull/needed_components.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

namespace atrium::hull {
namespace {

// Cells along the largest component. An area counts from three cells in both directions on: 4 cm of
// a person, more than outlines are wrong by.
constexpr float kCellsPerComponent = 128.0f;
constexpr float kLeastCell_px = 1.5f;
constexpr float kMostCells = 512.0f;      // along each side
constexpr std::uint32_t kLeastInner = 2;  // cells
constexpr std::uint32_t kLeastInnerShare =
    128;                                  // of a component's own, at least one part in so many
constexpr std::uint32_t kLeastThin = 32;  // cells of a part too thin for inner ones
constexpr int kLeastViews = 3;            // cones of two cameras meet nearly everywhere
constexpr double kDominant = 0.9;         // of all volume: others cannot explain so much
constexpr std::uint32_t kNone = 0xffffffffu;

constexpr std::uint64_t bit(std::size_t i) { return std::uint64_t{1} << i; }

int first_centre(float at) { return static_cast<int>(std::ceil(at - 0.5f)); }

// Sets `bits` in the cells whose centre the triangle covers. Neighbours neither overlap nor leave a
// gap, since both compute the same places on their edge.
void fill_triangle(std::array<Eigen::Vector2f, 3> p,
                   int width,
                   int height,
                   std::uint64_t bits,
                   std::uint64_t* cells) {
    std::sort(p.begin(), p.end(), [](const Eigen::Vector2f& a, const Eigen::Vector2f& b) {
        return a.y() < b.y() || (a.y() == b.y() && a.x() < b.x());
    });
    const auto x_at = [](const Eigen::Vector2f& from, const Eigen::Vector2f& to, float y) {
        return from.x() + (to.x() - from.x()) * ((y - from.y()) / (to.y() - from.y()));
    };
    const int last = std::min(first_centre(p[2].y()), height);
    for (int row = std::max(first_centre(p[0].y()), 0); row < last; ++row) {
        const float y = static_cast<float>(row) + 0.5f;
        const float x_long = x_at(p[0], p[2], y);
        const float x_short = y < p[1].y() ? x_at(p[0], p[1], y) : x_at(p[1], p[2], y);
        const int begin = std::max(first_centre(std::min(x_long, x_short)), 0);
        const int end = std::min(first_centre(std::max(x_long, x_short)), width);
        std::uint64_t* const cells_of_row = cells + std::ptrdiff_t{row} * width;
        for (int x = begin; x < end; ++x) cells_of_row[x] |= bits;
    }
}

// True for triangles that cover no cell of the raster, and for some with NaN.
bool is_beside(const std::array<Eigen::Vector2f, 3>& p, int width, int height) {
    const auto beside = [&](int axis, int size) {
        const float end = static_cast<float>(size);
        return (p[0][axis] < 0.0f && p[1][axis] < 0.0f && p[2][axis] < 0.0f) ||
               (p[0][axis] > end && p[1][axis] > end && p[2][axis] > end);
    };
    return beside(0, width) || beside(1, height);
}

void count(std::uint64_t set, std::array<std::uint32_t, 64>& counts) {
    for (; set != 0; set &= set - 1) ++counts[static_cast<std::size_t>(std::countr_zero(set))];
}

}  // namespace

std::uint32_t NeededComponents::find_root(std::uint32_t v) {
    while (parent_[v] != v) v = parent_[v] = parent_[parent_[v]];
    return v;
}

void NeededComponents::find_components(const geometry::TriangleMesh& mesh) {
    const std::size_t num_vertices = mesh.vertices.size();
    parent_.resize(num_vertices);
    for (std::uint32_t v = 0; v < num_vertices; ++v) parent_[v] = v;
    for (const auto& [a, b, c] : mesh.triangles) {
        const std::uint32_t roots[] = {find_root(a), find_root(b), find_root(c)};
        const std::uint32_t least = std::min({roots[0], roots[1], roots[2]});
        for (const std::uint32_t root : roots) parent_[root] = least;
    }
    components_.clear();
    new_index_.assign(num_vertices, kNone);  // of a root: its component
    for (std::uint32_t v = 0; v < num_vertices; ++v) {
        if (find_root(v) != v) continue;
        new_index_[v] = static_cast<std::uint32_t>(components_.size());
        components_.push_back({v, 0.0});
    }
    for (const auto& [a, b, c] : mesh.triangles) {
        Component& component = components_[new_index_[find_root(a)]];
        const Eigen::Vector3d& from = mesh.vertices[component.root];
        component.six_volumes +=
            (mesh.vertices[a] - from).dot((mesh.vertices[b] - from).cross(mesh.vertices[c] - from));
    }
    std::sort(components_.begin(), components_.end(), [](const Component& a, const Component& b) {
        return a.six_volumes > b.six_volumes || (a.six_volumes == b.six_volumes && a.root < b.root);
    });
    for (std::uint32_t i = 0; i < components_.size(); ++i) new_index_[components_[i].root] = i;
    double sum = 0.0;
    for (const Component& component : components_) sum += component.six_volumes;
    has_dominant_ = components_.front().six_volumes > kDominant * sum;
    bit_of_.resize(num_vertices);
    for (std::uint32_t v = 0; v < num_vertices; ++v) {
        bit_of_[v] = static_cast<std::uint8_t>(
            std::min<std::uint32_t>(new_index_[find_root(v)], std::uint32_t{kMost}));
    }
}

// Projects the vertices and lays the raster around the components, within the field of the view. A
// dominant one is drawn only where the others are.
void NeededComponents::project(const SilhouetteView& view,
                               const geometry::TriangleMesh& mesh,
                               Raster& raster) const {
    const std::size_t num = std::min(components_.size(), kMost);
    raster.points.resize(mesh.vertices.size());
    raster.seen_whole = num == kMost ? ~Set{0} : bit(num) - 1;
    std::array<Eigen::AlignedBox2f, kMost> boxes;
    Eigen::AlignedBox2f field;
    for (const Eigen::Vector2d& p : view.field) field.extend(p.cast<float>());
    for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
        const std::size_t component = bit_of_[v];
        if (component == kMost) continue;
        const Eigen::Vector3d p = view.camera_from_site * mesh.vertices[v];
        Eigen::Vector2f& point = raster.points[v];
        if (p.z() > 0.0) {
            point = view.intrinsics.project(p).cast<float>();
            boxes[component].extend(point);
        } else {
            point.setConstant(std::numeric_limits<float>::quiet_NaN());
        }
        const bool is_seen = p.z() > 0.0 && (view.field.empty() || field.contains(point));
        if (!is_seen) raster.seen_whole &= ~bit(component);
    }
    Eigen::AlignedBox2f all;
    float largest_px = 0.0f;
    for (std::size_t c = 0; c < num; ++c) {
        if (!view.field.empty()) boxes[c] = boxes[c].intersection(field);
        if (boxes[c].isEmpty()) continue;
        if (c > 0 || !has_dominant_) all.extend(boxes[c]);
        largest_px = std::max(largest_px, boxes[c].sizes().maxCoeff());
    }
    raster.width = raster.height = 0;
    if (all.isEmpty() || !all.sizes().allFinite()) return;
    const float cell_px = std::max(
        {largest_px / kCellsPerComponent, kLeastCell_px, all.sizes().maxCoeff() / kMostCells});
    raster.width = static_cast<int>(all.sizes().x() / cell_px) + 1;
    raster.height = static_cast<int>(all.sizes().y() / cell_px) + 1;
    for (Eigen::Vector2f& point : raster.points) point = (point - all.min()) / cell_px;
}

void NeededComponents::draw(const SilhouetteView& view,
                            const geometry::TriangleMesh& mesh,
                            Raster& raster) const {
    project(view, mesh, raster);
    raster.cells.assign(
        static_cast<std::size_t>(raster.width) * static_cast<std::size_t>(raster.height), 0);
    if (raster.cells.empty()) return;
    for (const auto& [a, b, c] : mesh.triangles) {
        if (bit_of_[a] == kMost) continue;
        const std::array<Eigen::Vector2f, 3> p{
            raster.points[a], raster.points[b], raster.points[c]};
        // one side of a closed surface covers as much as both; NaN is on neither
        const Eigen::Vector2f u = p[1] - p[0];
        const Eigen::Vector2f w = p[2] - p[0];
        if (is_beside(p, raster.width, raster.height)) continue;
        if (u.x() * w.y() - u.y() * w.x() > 0.0f)
            fill_triangle(p, raster.width, raster.height, bit(bit_of_[a]), raster.cells.data());
    }
    const Set all = ~Set{0};
    measure(raster, Kind::kOwn, all, 0, raster.own);
}

// Counts the cells of the components `alive`. kAlone: where no other one is. kBeyond: where none of
// `explaining` is.
void NeededComponents::measure(Raster& raster, Kind kind, Set alive, Set explaining, Areas& areas) {
    areas = {};
    const int width = raster.width;
    const auto of = [&](Set cell) {
        const Set here = cell & alive;
        // without std::has_single_bit, which calls a function on processors without popcnt
        if (kind == Kind::kAlone && (here & (here - 1)) != 0) return Set{0};
        return (here & explaining) != 0 ? Set{0} : here;
    };
    // of each cell what it has in common with its neighbours on the left and right
    raster.beside.resize(raster.cells.size());
    for (int y = 0; y < raster.height; ++y) {
        const Set* const cells = raster.cells.data() + std::ptrdiff_t{y} * width;
        Set* const beside = raster.beside.data() + std::ptrdiff_t{y} * width;
        Set before = 0;
        Set here = of(cells[0]);
        for (int x = 0; x < width; ++x) {
            count(here, areas.all);
            const Set next = x + 1 < width ? of(cells[x + 1]) : 0;
            beside[x] = before & here & next;
            before = here;
            here = next;
        }
    }
    for (int y = 1; y + 1 < raster.height; ++y) {
        const Set* const beside = raster.beside.data() + std::ptrdiff_t{y} * width;
        for (int x = 0; x < width; ++x)
            count(beside[x - width] & beside[x] & beside[x + width], areas.inner);
    }
}

// The components of which some view shows a compact part, or nearly all, or two views show most.
NeededComponents::Set NeededComponents::needed(Kind kind, Set alive, Set explaining) {
    Set result = 0;
    Set once = 0;
    for (std::size_t v = 0; v < num_views_; ++v) {
        Raster& raster = rasters_[v];
        measure(raster, kind, alive, explaining, raster.need);
        const Areas& need = raster.need;
        const Areas& own = raster.own;
        for (Set left = alive & ~explaining; left != 0; left &= left - 1) {
            const auto c = static_cast<std::size_t>(std::countr_zero(left));
            const bool is_compact =
                need.inner[c] >= kLeastInner && need.inner[c] * kLeastInnerShare >= own.inner[c];
            const bool is_most = 2 * need.all[c] > own.all[c];
            if (is_compact || (is_most && (need.all[c] >= kLeastThin || (once & bit(c)) != 0)))
                result |= bit(c);
            else if (is_most)
                once |= bit(c);
        }
    }
    return result;
}

// Reduces the choice as a cover of sets is reduced: components that alone explain something are
// sure; those whose silhouettes the sure ones explain are not needed; of two where one explains all
// that the other does, and more, the other one is not needed. What remains is ambiguous and kept.
NeededComponents::Set NeededComponents::choose(Set all) {
    Set droppable = 0;
    for (Set left = all; left != 0; left &= left - 1) {
        const Set one = left & (~left + 1);
        const auto num_whole =
            std::count_if(rasters_.begin(),
                          rasters_.begin() + static_cast<std::ptrdiff_t>(num_views_),
                          [&](const Raster& raster) { return (raster.seen_whole & one) != 0; });
        if (num_whole >= kLeastViews) droppable |= one;
    }
    Set alive = all;
    Set sure = all & ~droppable;
    if (has_dominant_) sure |= bit(0);
    while (true) {
        const Set before = alive & ~sure;
        if (before == 0) return alive;
        sure |= needed(Kind::kAlone, alive, 0);
        alive &= sure | needed(Kind::kBeyond, alive, sure);
        if ((alive & ~sure) != before) continue;
        const Set lesser = dominated(alive, sure);
        if (lesser == 0) return alive;
        alive &= ~lesser;
    }
}

// Returns the smallest doubtful component that another doubtful one makes superfluous but not the
// other way round; 0 without one.
NeededComponents::Set NeededComponents::dominated(Set alive, Set sure) {
    const Set doubtful = alive & ~sure;
    std::array<Set, kMost> needed_beside{};  // by component: the ones still needed if it is kept
    for (Set left = doubtful; left != 0; left &= left - 1)
        needed_beside[static_cast<std::size_t>(std::countr_zero(left))] =
            needed(Kind::kBeyond, alive, sure | (left & (~left + 1)));
    for (std::size_t c = kMost; c-- > 0;) {  // the smallest first
        if ((doubtful & bit(c)) == 0) continue;
        for (Set left = doubtful & ~bit(c); left != 0; left &= left - 1) {
            const auto other = static_cast<std::size_t>(std::countr_zero(left));
            if ((needed_beside[other] & bit(c)) == 0 && (needed_beside[c] & bit(other)) != 0)
                return bit(c);
        }
    }
    return 0;
}

void NeededComponents::write(Set kept, VisualHull& hull) {
    const std::size_t num = std::min(components_.size(), kMost);
    for (std::size_t c = 0; c < num; ++c) {
        if ((kept & bit(c)) != 0) continue;
        --hull.num_components;
        ++hull.num_phantoms_dropped;
        hull.volume_dropped_m3 += std::max(components_[c].six_volumes, 0.0) / 6.0;
    }
    std::uint32_t num_kept = 0;
    std::vector<Eigen::Vector3d>& vertices = hull.mesh.vertices;
    for (std::size_t v = 0; v < vertices.size(); ++v) {
        const bool is_kept = bit_of_[v] == kMost || (kept & bit(bit_of_[v])) != 0;
        new_index_[v] = is_kept ? num_kept : kNone;
        if (is_kept) vertices[num_kept++] = vertices[v];
    }
    vertices.resize(num_kept);
    auto triangle = hull.mesh.triangles.begin();
    for (const auto& [a, b, c] : hull.mesh.triangles) {
        if (new_index_[a] == kNone) continue;
        *triangle++ = {new_index_[a], new_index_[b], new_index_[c]};
    }
    hull.mesh.triangles.erase(triangle, hull.mesh.triangles.end());
}

void NeededComponents::keep_only(std::span<const CleanViews::View> views,
                                 Executor& executor,
                                 VisualHull& hull) {
    if (hull.num_components < 2 || views.size() < kLeastViews) return;
    find_components(hull.mesh);
    num_views_ = views.size();
    if (rasters_.size() < num_views_) rasters_.resize(num_views_);
    const auto draw_view = [&](std::size_t v, std::size_t) {
        draw(*views[v].source, hull.mesh, rasters_[v]);
    };
    executor.parallel_for(num_views_, draw_view);
    const std::size_t num = std::min(components_.size(), kMost);
    const Set all = num == kMost ? ~Set{0} : bit(num) - 1;
    const Set kept = choose(all);
    if (kept != all) write(kept, hull);
}

}  // namespace atrium::hull
