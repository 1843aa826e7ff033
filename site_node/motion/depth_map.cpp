#include "site_node/motion/depth_map.hpp"

#include "site_node/motion/motion_picture.hpp"

#include <algorithm>
#include <cmath>

namespace atrium::motion {
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
    const float low = std::min({a.y(), b.y(), c.y()});
    const float high = std::max({a.y(), b.y(), c.y()});
    if (!(high >= 0.0F && low <= static_cast<float>(height_ - 1))) return;
    const int first_row = static_cast<int>(std::ceil(std::max(low, 0.0F)));
    const int last_row =
        static_cast<int>(std::floor(std::min(high, static_cast<float>(height_ - 1))));
    for (int row = first_row; row <= last_row; ++row) {
        const auto y = static_cast<float>(row);
        float from = static_cast<float>(width_);
        float to = -1.0F;
        const auto cross_edge = [&](const Eigen::Vector3f& p, const Eigen::Vector3f& q) {
            if ((p.y() <= y) == (q.y() <= y)) return;
            const float x = p.x() + (y - p.y()) / (q.y() - p.y()) * (q.x() - p.x());
            from = std::min(from, x);
            to = std::max(to, x);
        };
        cross_edge(a, b);
        cross_edge(b, c);
        cross_edge(c, a);
        const int first = static_cast<int>(std::ceil(std::max(from, 0.0F)));
        const int last = static_cast<int>(std::floor(std::min(to, static_cast<float>(width_ - 1))));
        float* const line = inverse_depth_.data() + static_cast<std::ptrdiff_t>(row) * width_;
        for (int x = first; x <= last; ++x) {
            const float inverse =
                a.z() + per_column * (static_cast<float>(x) - a.x()) + per_row * (y - a.y());
            line[x] = std::max(line[x], std::clamp(inverse, furthest, nearest));
        }
    }
}

}  // namespace atrium::motion
