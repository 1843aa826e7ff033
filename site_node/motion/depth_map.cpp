#include "site_node/motion/depth_map.hpp"

#include "site_node/motion/motion_picture.hpp"

#include <algorithm>
#include <array>
#include <utility>

namespace atrium::motion {
namespace {

// Rounds up; faster than std::ceil without SSE 4.1. Not negative.
int first_at_least(float value) {
    const int whole = static_cast<int>(value);
    return static_cast<float>(whole) < value ? whole + 1 : whole;
}

}  // namespace

void DepthMap::draw(const geometry::TriangleMesh& mesh_site,
                    const geometry::CalibratedCamera& camera,
                    const image::PixelRect& rect) {
    width_ = rect.width;
    height_ = rect.height;
    inverse_depth_.assign(static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_),
                          0.0F);
    projected_.clear();
    const Eigen::Matrix3d rotation = camera.camera_from_site.rotation.toRotationMatrix();
    const bool bends = camera.intrinsics.has_distortion();
    for (const Eigen::Vector3d& vertex : mesh_site.vertices) {
        const Eigen::Vector3d p = rotation * vertex + camera.camera_from_site.translation;
        if (p.z() < kNearestSurface_m) {
            projected_.push_back(Eigen::Vector3f::Zero());
            continue;
        }
        Eigen::Vector2d px = camera.intrinsics.project(p);
        if (bends) px = camera.intrinsics.distort(px);
        px = reduced_px(px) - Eigen::Vector2d(rect.x, rect.y);
        projected_.emplace_back(static_cast<float>(px.x()),
                                static_cast<float>(px.y()),
                                static_cast<float>(1.0 / p.z()));
    }
    for (const auto& [i, j, k] : mesh_site.triangles)
        draw_triangle(projected_[i], projected_[j], projected_[k]);
}

// Fills the spans of the rows whose centres are inside. The inverse depth is linear in the picture.
void DepthMap::draw_triangle(const Eigen::Vector3f& a,
                             const Eigen::Vector3f& b,
                             const Eigen::Vector3f& c) {
    if (a.z() == 0.0F || b.z() == 0.0F || c.z() == 0.0F) return;
    const Eigen::Vector3f ab = b - a;
    const Eigen::Vector3f ac = c - a;
    const float area = ab.x() * ac.y() - ab.y() * ac.x();
    if (area >= -1e-6F) return;  // faces away; rows grow downwards
    const float per_column = (ab.z() * ac.y() - ac.z() * ab.y()) / area;
    const float per_row = (ac.z() * ab.x() - ab.z() * ac.x()) / area;
    // the slopes of thin triangles are not exact
    const float furthest = std::min({a.z(), b.z(), c.z()});
    const float nearest = std::max({a.z(), b.z(), c.z()});
    // the long edge from the top to the bottom, and the two on its other side
    std::array<const Eigen::Vector3f*, 3> sorted{&a, &b, &c};
    const auto order = [&](std::size_t upper, std::size_t lower) {
        if (sorted[lower]->y() < sorted[upper]->y()) std::swap(sorted[lower], sorted[upper]);
    };
    order(0, 1);
    order(1, 2);
    order(0, 1);
    const auto slope = [](const Eigen::Vector3f& p, const Eigen::Vector3f& q) {
        return q.y() > p.y() ? (q.x() - p.x()) / (q.y() - p.y()) : 0.0F;
    };
    const float long_slope = slope(*sorted[0], *sorted[2]);
    const float upper_slope = slope(*sorted[0], *sorted[1]);
    const float lower_slope = slope(*sorted[1], *sorted[2]);
    const float low = sorted[0]->y();
    const float high = std::min(sorted[2]->y(), static_cast<float>(height_ - 1));
    // written so that what is not a number draws nothing
    if (!(high >= 0.0F && low <= high)) return;
    const int first_row = first_at_least(std::max(low, 0.0F));
    const int last_row = static_cast<int>(high);
    const auto last_column = static_cast<float>(width_ - 1);
    for (int row = first_row; row <= last_row; ++row) {
        const auto y = static_cast<float>(row);
        const float one = sorted[0]->x() + long_slope * (y - sorted[0]->y());
        const float other = y < sorted[1]->y()
                                ? sorted[0]->x() + upper_slope * (y - sorted[0]->y())
                                : sorted[1]->x() + lower_slope * (y - sorted[1]->y());
        const float from = std::max(std::min(one, other), 0.0F);
        const float to = std::min(std::max(one, other), last_column);
        if (!(from <= to)) continue;
        const int first = first_at_least(from);
        const int last = static_cast<int>(to);
        // most rows of thin triangles lie between two pixels
        if (first > last) continue;
        float* const line = inverse_depth_.data() + static_cast<std::ptrdiff_t>(row) * width_;
        for (int x = first; x <= last; ++x) {
            const float inverse =
                a.z() + per_column * (static_cast<float>(x) - a.x()) + per_row * (y - a.y());
            line[x] = std::max(line[x], std::clamp(inverse, furthest, nearest));
        }
    }
}

}  // namespace atrium::motion
