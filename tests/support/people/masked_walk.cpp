#include "tests/support/people/masked_walk.hpp"

#include "core/image/image.hpp"
#include "site_node/silhouette/silhouette.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace atrium::test {
namespace {

// Sets the pixels whose centres are inside a triangle, in either orientation.
void fill(const std::array<Eigen::Vector2d, 3>& corners, image::Mask& mask) {
    double top = corners[0].y(), bottom = corners[0].y();
    for (const Eigen::Vector2d& corner : corners) {
        top = std::min(top, corner.y());
        bottom = std::max(bottom, corner.y());
    }
    const int first = std::max(0, static_cast<int>(std::ceil(top)));
    const int last = std::min(mask.height - 1, static_cast<int>(std::floor(bottom)));
    for (int y = first; y <= last; ++y) {
        double left = mask.width, right = -1.0;
        for (std::size_t i = 0; i < 3; ++i) {
            const Eigen::Vector2d& a = corners[i];
            const Eigen::Vector2d& b = corners[(i + 1) % 3];
            if ((a.y() <= y) == (b.y() <= y)) continue;
            const double x = a.x() + (y - a.y()) / (b.y() - a.y()) * (b.x() - a.x());
            left = std::min(left, x);
            right = std::max(right, x);
        }
        const int begin = std::max(0, static_cast<int>(std::ceil(left)));
        const int end = std::min(mask.width - 1, static_cast<int>(std::floor(right)));
        if (begin <= end) std::fill(mask.row(y) + begin, mask.row(y) + end + 1, 255);
    }
}

}  // namespace

coherence::Sight masked_sight(const WalkingPeople& people,
                              double time_s,
                              std::span<const geometry::CalibratedCamera> cameras) {
    coherence::Sight sight;
    silhouette::SilhouetteScratch scratch;
    for (const geometry::CalibratedCamera& camera : cameras) {
        image::Mask mask(camera.intrinsics.width, camera.intrinsics.height);
        for (std::size_t i = 0; i < people.size(); ++i) {
            std::vector<Eigen::Vector2d> px;
            for (const Eigen::Vector3d& p : people.skin(i, time_s))
                px.push_back(camera.intrinsics.project(camera.camera_from_site * p));
            for (const auto& [a, b, c] : people.triangles(i)) fill({px[a], px[b], px[c]}, mask);
        }
        std::vector<silhouette::SilhouettePolygon> polygons;
        silhouette::extract_silhouette(mask, camera.intrinsics, {}, scratch, polygons);
        std::vector<std::vector<Eigen::Vector2d>> contours;
        for (const auto& polygon : polygons) contours.push_back(polygon.vertices_px);
        sight.now.push_back(coherence::hull_of(contours, camera.intrinsics));
    }
    return sight;
}

}  // namespace atrium::test
