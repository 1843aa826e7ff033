#include "core/geometry/collapse_map.hpp"

#include <algorithm>
#include <cassert>

namespace atrium::geometry {
namespace {

using Eigen::Vector3d;

double share(double part, double whole) {
    return whole > 0.0 ? std::clamp(part / whole, 0.0, 1.0) : 0.0;
}

// Scalar products of three vectors.
struct Products {
    Products(const Vector3d& u, const Vector3d& v, const Vector3d& w)
        : uu(u.squaredNorm()),
          uv(u.dot(v)),
          vv(v.squaredNorm()),
          uw(u.dot(w)),
          vw(v.dot(w)),
          determinant(uu * vv - uv * uv) {}
    double uu, uv, vv, uw, vw;
    double determinant;  // 0 if u and v are parallel
};

Vector3d nearest_on_segment(const Vector3d& p, const Vector3d& a, const Vector3d& b) {
    const Vector3d ab = b - a;
    return a + share((p - a).dot(ab), ab.squaredNorm()) * ab;
}

// The bound is valid for any point of the triangle; a nearer one makes it tighter.
Vector3d nearest_on_triangle(const Vector3d& p,
                             const Vector3d& a,
                             const Vector3d& b,
                             const Vector3d& c) {
    const Vector3d ab = b - a;
    const Vector3d ac = c - a;
    const Products of(ab, ac, p - a);
    const double s = of.vv * of.uw - of.uv * of.vw;
    const double t = of.uu * of.vw - of.uv * of.uw;
    if (s > 0.0 && t > 0.0 && s + t < of.determinant)
        return a + (s / of.determinant) * ab + (t / of.determinant) * ac;
    const std::array<Vector3d, 3> feet{
        nearest_on_segment(p, a, b), nearest_on_segment(p, b, c), nearest_on_segment(p, c, a)};
    return *std::min_element(feet.begin(), feet.end(), [&](const auto& l, const auto& r) {
        return (l - p).squaredNorm() < (r - p).squaredNorm();
    });
}

// Parameter in [from, 1] of the point on the segment p q nearest to the segment a b.
double nearest_parameter(
    const Vector3d& p, const Vector3d& q, const Vector3d& a, const Vector3d& b, double from) {
    const Products of(q - p, b - a, p - a);
    double s = from;
    if (of.determinant > 0.0)
        s = std::clamp((of.uv * of.vw - of.uw * of.vv) / of.determinant, from, 1.0);
    const double t = of.vv > 0.0 ? (of.uv * s + of.vw) / of.vv : 0.0;
    // if the foot lies beyond an end of a b: nearest to that end
    if (t < 0.0 && of.uu > 0.0) s = std::clamp(-of.uw / of.uu, from, 1.0);
    if (t > 1.0 && of.uu > 0.0) s = std::clamp((of.uv - of.uw) / of.uu, from, 1.0);
    return s;
}

}  // namespace

bool CollapseMap::bound(const Vector3d& u,
                        std::span<const Vector3d> ring,
                        std::span<const DisplacementBox> before,
                        double max_m,
                        double rounding_m) {
    assert(ring.size() >= 3 && ring.size() <= kMaxRing && before.size() == ring.size());
    ring_ = ring;
    find_nearest(u);
    // u has not been displaced before: it is a vertex of the input
    if (!(at_u_.matrix().squaredNorm() <= max_m * max_m)) return false;
    const std::size_t k = ring.size();
    for (std::size_t l = 0; l < k; ++l) crossing_[0][l] = crossing_[k][l] = Eigen::Array3d::Zero();
    for (std::size_t i = 1; i < k; ++i) cross_edges(u, i);
    for (std::size_t l = 1; l + 1 < k; ++l) after_[l] = DisplacementBox::none();
    for (std::size_t i = 0; i < k; ++i) map_triangle(i, before[i]);
    for (std::size_t l = 1; l + 1 < k; ++l) {
        after_[l].low -= rounding_m;
        after_[l].high += rounding_m;
        if (!(after_[l].longest_m() <= max_m)) return false;
    }
    return true;
}

void CollapseMap::find_nearest(const Vector3d& u) {
    double best = std::numeric_limits<double>::infinity();
    nearest_ = 1;
    at_u_ = ring_[0] - u;
    for (std::size_t l = 1; l + 1 < ring_.size(); ++l) {
        const Vector3d d = nearest_on_triangle(u, ring_[0], ring_[l], ring_[l + 1]) - u;
        if (!(d.squaredNorm() < best)) continue;
        best = d.squaredNorm();
        nearest_ = l;
        at_u_ = d;
    }
}

void CollapseMap::cross_edges(const Vector3d& u, std::size_t spoke) {
    const Vector3d& w = ring_[spoke];
    crossing_[spoke][spoke] = Eigen::Array3d::Zero();
    double s = 0.0;
    const auto cross = [&](std::size_t l) {
        s = nearest_parameter(u, w, ring_[0], ring_[l], s);
        const Vector3d p = u + s * (w - u);
        crossing_[spoke][l] = nearest_on_segment(p, ring_[0], ring_[l]) - p;
    };
    for (std::size_t l = nearest_ + 1; l < spoke; ++l) cross(l);
    for (std::size_t l = nearest_; l > spoke; --l) cross(l);
}

// Maps T_i to S_j and to the triangles between S_j and its own position in the fan.
void CollapseMap::map_triangle(std::size_t i, const DisplacementBox& before) {
    const std::size_t own = std::clamp<std::size_t>(i, 1, ring_.size() - 2);
    const std::size_t first = std::min(own, nearest_);
    const std::size_t last = std::max(own, nearest_);
    for (std::size_t l = first; l <= last; ++l) {
        DisplacementBox moved = DisplacementBox::none();
        if (l == nearest_) moved.add(at_u_);
        if (l == own) moved.add(Eigen::Array3d::Zero());  // the border between w_i and w_(i+1)
        // corners on the edges of S_l that T_i crosses
        const auto add_corners = [&](std::size_t edge) {
            moved.add(crossing_[i][edge]);
            moved.add(crossing_[i + 1][edge]);
        };
        if (l > first) add_corners(l);
        if (l < last) add_corners(l + 1);
        moved.low += before.low;
        moved.high += before.high;
        after_[l].add(moved);
    }
}

}  // namespace atrium::geometry
