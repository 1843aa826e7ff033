#include "site_node/hull/better_diagonals.hpp"

#include <algorithm>
#include <cmath>

namespace atrium::hull {
namespace {

// The sine of an angle counts as nonzero if it exceeds this fraction of the product of the legs:
// 1000 times the rounding error, so no two exchanges undo each other.
constexpr double kMargin = 1e-12;

// Limit on exchanges per triangle. Faces of people need about one. The limit ends the endless loop
// that rounding of extreme coordinates could cause.
constexpr std::size_t kMaxExchanges = 16;

/// The angle at `apex` from `a` to `b`, with sine and cosine scaled by the product of the legs.
struct Angle {
    Angle(const Eigen::Vector2d& apex, const Eigen::Vector2d& a, const Eigen::Vector2d& b)
        : to_a(a - apex), to_b(b - apex) {}
    double sine() const { return to_a.x() * to_b.y() - to_a.y() * to_b.x(); }
    double cosine() const { return to_a.x() * to_b.x() + to_a.y() * to_b.y(); }
    /// The product of the legs, in another norm: 1 to 2 times the Euclidean one.
    double size() const {
        return (std::abs(to_a.x()) + std::abs(to_a.y())) *
               (std::abs(to_b.x()) + std::abs(to_b.y()));
    }
    Eigen::Vector2d to_a;
    Eigen::Vector2d to_b;
};

}  // namespace

void BetterDiagonals::improve(std::span<const Eigen::Vector2d> corners_m,
                              std::span<std::array<std::uint32_t, 3>> triangles,
                              std::span<const Lines> lines) {
    if (triangles.size() < 2) return;
    corners_m_ = corners_m;
    lines_ = lines;
    if (!copy(triangles)) return;
    are_few_ = corners_m.size() <= kFewCorners && first_corner_.size() <= kFewEdges;
    if (!are_few_ || !find_twins_of_few()) find_twins();
    to_check_.clear();
    const auto num_edges = static_cast<Edge>(first_corner_.size());
    const Edge* const twins = twin_.data();
    for (Edge e = 0; e < num_edges; e += 4) {
        for (Edge of_triangle = e; of_triangle < e + 3; ++of_triangle) {
            if (twins[of_triangle] > of_triangle) to_check_.push_back(of_triangle);
        }
    }
    const std::size_t most = kMaxExchanges * triangles.size();
    std::size_t num_left = most;
    while (!to_check_.empty() && num_left > 0) {
        const Edge e = to_check_.back();
        to_check_.pop_back();
        if (!exchange_helps(e)) continue;
        exchange(e);
        --num_left;
    }
    if (num_left == most) return;
    for (std::size_t t = 0; t < triangles.size(); ++t)
        std::copy_n(&first_corner_[4 * t], 3, triangles[t].begin());
}

// Copies the triangles and finds their orientation. False if they cannot be improved.
bool BetterDiagonals::copy(std::span<const std::array<std::uint32_t, 3>> triangles) {
    first_corner_.resize(4 * triangles.size());
    twin_.resize(4 * triangles.size());
    std::uint32_t* to = first_corner_.data();
    const Eigen::Vector2d* const corners_m = corners_m_.data();
    double twice_area = 0.0;
    for (const auto& [a, b, c] : triangles) {
        if (std::max({a, b, c}) >= corners_m_.size()) return false;
        if (a == b || b == c || c == a) return false;
        twice_area += Angle(corners_m[a], corners_m[b], corners_m[c]).sine();
        to[0] = a;
        to[1] = b;
        to[2] = c;
        to += 4;
    }
    orientation_ = twice_area < 0.0 ? -1.0 : 1.0;
    return std::abs(twice_area) > 0.0;
}

// False if two half-edges join the same two corners in the same direction.
bool BetterDiagonals::find_twins_of_few() {
    const auto num_edges = static_cast<Edge>(first_corner_.size());
    std::uint8_t* const table = few_.data();
    std::fill_n(table, corners_m_.size() * kFewCorners, std::uint8_t{0});
    const std::uint32_t* corners = first_corner_.data();
    unsigned twice = 0;
    const auto enter = [&](std::uint32_t from, std::uint32_t to, Edge e) {
        std::uint8_t& entry = table[from * kFewCorners + to];
        twice |= entry;
        entry = static_cast<std::uint8_t>(e + 1);
    };
    for (Edge e = 0; e < num_edges; e += 4, corners += 4) {
        enter(corners[0], corners[1], e);
        enter(corners[1], corners[2], e + 1);
        enter(corners[2], corners[0], e + 2);
    }
    corners = first_corner_.data();
    Edge* twins = twin_.data();
    const auto twin = [&](std::uint32_t from, std::uint32_t to) {
        return static_cast<Edge>(table[to * kFewCorners + from]) - 1;
    };
    for (Edge e = 0; e < num_edges; e += 4, corners += 4, twins += 4) {
        twins[0] = twin(corners[0], corners[1]);
        twins[1] = twin(corners[1], corners[2]);
        twins[2] = twin(corners[2], corners[0]);
    }
    return twice == 0;
}

void BetterDiagonals::find_twins() {
    are_few_ = false;
    const auto num_edges = static_cast<Edge>(first_corner_.size());
    first_at_.assign(corners_m_.size(), kNone);
    next_at_.resize(static_cast<std::size_t>(num_edges));
    for (Edge e = 0; e < num_edges; e = in_list_after(e)) {
        Edge& first = first_at_[from(e)];
        next_at_[static_cast<std::size_t>(e)] = first;
        first = e;
    }
    twin_.assign(static_cast<std::size_t>(num_edges), kNone);
    bool is_sound = true;
    for (Edge e = 0; e < num_edges; e = in_list_after(e)) {
        if (twin_[static_cast<std::size_t>(e)] != kNone) continue;
        const Edge twin = only_edge(to(e), from(e));
        if (twin == kNone) continue;
        is_sound &= twin_[static_cast<std::size_t>(twin)] == kNone;
        twin_[static_cast<std::size_t>(e)] = twin;
        twin_[static_cast<std::size_t>(twin)] = e;
    }
    if (is_sound) return;
    // a non-manifold edge, with more than two triangles or two half-edges in one direction, has to
    // stay
    for (Edge e = 0; e < num_edges; e = in_list_after(e)) {
        const Edge twin = only_edge(to(e), from(e));
        const bool is_pair = twin != kNone && only_edge(from(e), to(e)) == e;
        twin_[static_cast<std::size_t>(e)] = is_pair ? twin : kNone;
    }
}

// Returns the half-edge from a to b; kNone if there is none or more than one.
BetterDiagonals::Edge BetterDiagonals::only_edge(std::uint32_t a, std::uint32_t b) {
    Edge found = kNone;
    for (Edge e = first_at_[a]; e != kNone; e = next_at_[static_cast<std::size_t>(e)]) {
        if (to(e) != b) continue;
        if (found != kNone) return kNone;
        found = e;
    }
    return found;
}

bool BetterDiagonals::are_joined(std::uint32_t a, std::uint32_t b) {
    if (are_few_) return (few(a, b) | few(b, a)) != 0;
    for (Edge e = first_at_[a]; e != kNone; e = next_at_[static_cast<std::size_t>(e)]) {
        if (to(e) == b || from(next(next(e))) == b) return true;
    }
    return false;
}

bool BetterDiagonals::on_one_line(std::uint32_t a, std::uint32_t b) const {
    if (lines_.empty()) return false;
    const Lines& l = lines_[a];
    const Lines& m = lines_[b];
    return (l[0] == m[0]) | (l[0] == m[1]) | (l[1] == m[0]) | (l[1] == m[1]);  // no branch
}

// With the triangles (a, b, c) and (b, a, d) on the two sides of `e`: the quadrilateral a d b c has
// to be convex at a and b, and the angles at c and d have to sum to more than 180 degrees.
bool BetterDiagonals::exchange_helps(Edge e) {
    const Edge twin = twin_[static_cast<std::size_t>(e)];
    if (twin == kNone) return false;  // on the boundary since an earlier exchange
    const std::uint32_t ic = from(before(e));
    const std::uint32_t id = from(before(twin));
    const Eigen::Vector2d* const corners_m = corners_m_.data();
    const Eigen::Vector2d& a = corners_m[from(e)];
    const Eigen::Vector2d& b = corners_m[from(twin)];
    const Eigen::Vector2d& c = corners_m[ic];
    const Eigen::Vector2d& d = corners_m[id];
    const Angle at_c(c, a, b);
    const Angle at_d(d, b, a);
    const double sine_of_sum =
        orientation_ * (at_c.sine() * at_d.cosine() + at_c.cosine() * at_d.sine());
    if (sine_of_sum >= 0.0) return false;
    if (!(sine_of_sum < -kMargin * (at_c.size() * at_d.size()))) return false;
    const Angle at_a(a, d, c);
    if (!(orientation_ * at_a.sine() > kMargin * at_a.size())) return false;
    const Angle at_b(b, c, d);
    if (!(orientation_ * at_b.sine() > kMargin * at_b.size())) return false;
    return ic != id && !on_one_line(ic, id) && !are_joined(ic, id);
}

// (a, b, c) becomes (a, d, c) and (b, a, d) becomes (b, c, d).
void BetterDiagonals::exchange(Edge e) {
    const auto twin_of = [&](Edge edge) -> Edge& { return twin_[static_cast<std::size_t>(edge)]; };
    const Edge f = twin_of(e);
    const Edge bc = next(e);
    const Edge ad = next(f);
    const Edge beyond_bc = twin_of(bc);
    const Edge beyond_ad = twin_of(ad);
    const std::uint32_t c = to(bc);
    const std::uint32_t d = to(ad);
    if (are_few_) {
        few(from(e), to(e)) = few(to(e), from(e)) = 0;
        few(d, c) = static_cast<std::uint8_t>(bc + 1);
        few(c, d) = static_cast<std::uint8_t>(ad + 1);
        few(from(e), d) = static_cast<std::uint8_t>(e + 1);
        few(from(f), c) = static_cast<std::uint8_t>(f + 1);
    }
    move(bc, d);  // now d c
    move(ad, c);  // now c d
    twin_of(bc) = ad;
    twin_of(ad) = bc;
    twin_of(e) = beyond_ad;
    twin_of(f) = beyond_bc;
    if (beyond_ad != kNone) twin_of(beyond_ad) = e;
    if (beyond_bc != kNone) twin_of(beyond_bc) = f;
    for (const Edge edge : {e, f, next(bc), next(ad)}) {
        if (twin_of(edge) != kNone) to_check_.push_back(edge);
    }
}

// Changes the first corner of `e`.
void BetterDiagonals::move(Edge e, std::uint32_t corner) {
    if (are_few_) {
        from(e) = corner;
        return;
    }
    Edge* link = &first_at_[from(e)];
    while (*link != e) link = &next_at_[static_cast<std::size_t>(*link)];
    *link = next_at_[static_cast<std::size_t>(e)];
    from(e) = corner;
    next_at_[static_cast<std::size_t>(e)] = first_at_[corner];
    first_at_[corner] = e;
}

}  // namespace atrium::hull
