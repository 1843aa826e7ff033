#include "tests/support/world/camera_masks.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace atrium::test {
namespace {

// Twice the signed area of a, b, c.
double cross(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Eigen::Vector2d& c) {
    return (b.x() - a.x()) * (c.y() - a.y()) - (b.y() - a.y()) * (c.x() - a.x());
}

// The columns of row `y` inside a triangle: [from, to] where its edges cross the row.
void fill_row(image::Mask& mask,
              int y,
              const Eigen::Vector2d& a,
              const Eigen::Vector2d& b,
              const Eigen::Vector2d& c) {
    double from = 1e9;
    double to = -1e9;
    const auto take_edge = [&](const Eigen::Vector2d& p, const Eigen::Vector2d& q) {
        if ((p.y() <= y) == (q.y() <= y)) return;
        const double x = p.x() + (y - p.y()) / (q.y() - p.y()) * (q.x() - p.x());
        from = std::min(from, x);
        to = std::max(to, x);
    };
    take_edge(a, b);
    take_edge(b, c);
    take_edge(c, a);
    if (from > to) return;
    const int first = std::max(0, static_cast<int>(std::ceil(from)));
    const int last = std::min(mask.width - 1, static_cast<int>(std::floor(to)));
    for (int x = first; x <= last; ++x) mask.row(y)[x] = 255;
}

}  // namespace

MaskPainter::MaskPainter(const geometry::CalibratedCamera& camera)
    : camera_(camera), mask_(camera.intrinsics.width, camera.intrinsics.height) {
    assert(!camera.intrinsics.has_distortion());
}

void MaskPainter::clear() { std::fill(mask_.data.begin(), mask_.data.end(), std::uint8_t{0}); }

void MaskPainter::draw(const geometry::TriangleMesh& mesh_site) {
    projected_.clear();
    for (const Eigen::Vector3d& vertex : mesh_site.vertices)
        projected_.push_back(camera_.intrinsics.project(camera_.camera_from_site * vertex));
    for (const auto& [i, j, k] : mesh_site.triangles) {
        const Eigen::Vector2d& a = projected_[i];
        const Eigen::Vector2d& b = projected_[j];
        const Eigen::Vector2d& c = projected_[k];
        // the back side covers the same pixels; rows grow downwards
        if (cross(a, b, c) > 0.0) continue;
        const double low = std::min({a.y(), b.y(), c.y()});
        const double high = std::max({a.y(), b.y(), c.y()});
        const int first = std::max(0, static_cast<int>(std::ceil(low)));
        const int last = std::min(mask_.height - 1, static_cast<int>(std::floor(high)));
        for (int y = first; y <= last; ++y) fill_row(mask_, y, a, b, c);
    }
}

void MaskPainter::flicker(double probability, Random& random) {
    before_ = mask_;
    std::uniform_real_distribution<double> chance(0.0, 1.0);
    for (int y = 1; y + 1 < mask_.height; ++y) {
        const std::uint8_t* row = before_.row(y);
        for (int x = 1; x + 1 < mask_.width; ++x) {
            const std::uint8_t own = row[x];
            const bool at_border = row[x - 1] != own || row[x + 1] != own ||
                                   before_.row(y - 1)[x] != own || before_.row(y + 1)[x] != own;
            if (at_border && chance(random) < probability)
                mask_.row(y)[x] = static_cast<std::uint8_t>(255 - own);
        }
    }
}

}  // namespace atrium::test
