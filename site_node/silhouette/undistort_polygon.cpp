#include "site_node/silhouette/undistort_polygon.hpp"

#include <optional>

namespace atrium::silhouette {
namespace {

constexpr double kMaxBendPx = 0.1;
// Longer edges are always split: their middle alone does not show how they bend.
constexpr double kLongEdgePx = 48.0;
constexpr int kMaxDepth = 10;

struct End {
    Eigen::Vector2d distorted_px;
    Eigen::Vector2d undistorted_px;
};

double distance_to_line_px(const Eigen::Vector2d& p,
                           const Eigen::Vector2d& a,
                           const Eigen::Vector2d& b) {
    const Eigen::Vector2d along = b - a;
    const double length = along.norm();
    if (length == 0.0) return (p - a).norm();
    return std::abs(along.x() * (p.y() - a.y()) - along.y() * (p.x() - a.x())) / length;
}

class EdgeBender {
public:
    EdgeBender(const geometry::PinholeCamera& intrinsics, std::vector<Eigen::Vector2d>& out)
        : lens_(intrinsics), out_(out) {}

    // Appends the vertices strictly between a and b. Returns false if one cannot be undistorted.
    bool bend(const End& a, const End& b, int depth) {
        const bool bent = is_bent(a, b);
        const bool is_long =
            (b.distorted_px - a.distorted_px).squaredNorm() > kLongEdgePx * kLongEdgePx;
        if ((!bent && !is_long) || depth == kMaxDepth) return true;
        const Eigen::Vector2d middle_px = 0.5 * (a.distorted_px + b.distorted_px);
        const std::optional<Eigen::Vector2d> middle = lens_.undistort(middle_px);
        if (!middle) return false;
        const End split{middle_px, *middle};
        const std::size_t before = out_.size();
        if (!bend(a, split, depth + 1)) return false;
        // a long edge that is straight needs no vertex in its middle
        const bool first_half_straight = out_.size() == before;
        out_.push_back(*middle);
        const std::size_t after = out_.size();
        if (!bend(split, b, depth + 1)) return false;
        if (!bent && first_half_straight && out_.size() == after) out_.pop_back();
        return true;
    }

private:
    // Distorting needs no iteration: compares the distorted middle of the undistorted edge with the
    // delivered edge, at the local scale of the lens.
    bool is_bent(const End& a, const End& b) const {
        const Eigen::Vector2d middle = lens_.distort(0.5 * (a.undistorted_px + b.undistorted_px));
        const double length_sq_px2 = (b.distorted_px - a.distorted_px).squaredNorm();
        const double undistorted_sq_px2 = (b.undistorted_px - a.undistorted_px).squaredNorm();
        const double limit_sq = kMaxBendPx * kMaxBendPx * length_sq_px2;
        const double distance_px = distance_to_line_px(middle, a.distorted_px, b.distorted_px);
        return distance_px * distance_px * undistorted_sq_px2 > limit_sq;
    }

    const geometry::PinholeCamera& lens_;
    std::vector<Eigen::Vector2d>& out_;
};

}  // namespace

bool undistort_polygon(std::span<const Eigen::Vector2d> distorted_px,
                       const geometry::PinholeCamera& intrinsics,
                       std::vector<Eigen::Vector2d>& undistorted_px,
                       std::vector<std::uint32_t>& edges) {
    undistorted_px.clear();
    edges.clear();
    if (distorted_px.empty()) return true;
    const bool straight = !intrinsics.has_distortion();
    EdgeBender bender(intrinsics, undistorted_px);
    const std::optional<Eigen::Vector2d> first = intrinsics.undistort(distorted_px[0]);
    if (!first) return false;
    End from{distorted_px[0], *first};
    for (std::size_t k = 0; k < distorted_px.size(); ++k) {
        const bool closing = k + 1 == distorted_px.size();
        const Eigen::Vector2d& to_px = distorted_px[closing ? 0 : k + 1];
        const std::optional<Eigen::Vector2d> to_undistorted =
            closing ? first : intrinsics.undistort(to_px);
        if (!to_undistorted) return false;
        const End to{to_px, *to_undistorted};
        undistorted_px.push_back(from.undistorted_px);
        if (!straight && !bender.bend(from, to, 0)) return false;
        edges.resize(undistorted_px.size(), static_cast<std::uint32_t>(k));
        from = to;
    }
    return true;
}

}  // namespace atrium::silhouette
