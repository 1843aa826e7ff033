#include "tools/visual_hull/coverage.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <utility>

namespace atrium::hull_tool {
namespace {

using Point = Eigen::Vector2d;

// The jitter of the hull is 1e-6 px at first, 1e-3 px with very degenerate input.
constexpr double kTolerance_px = 1e-3;
// Nearer to the camera, the hull's rounding of 1e-12 m would amount to pixels.
constexpr double kNear_m = 1e-4;

struct Raster {
    std::vector<std::uint8_t>& pixels;
    int width = 0;
    int height = 0;

    void fill(int row, double left, double right) {
        const double first = std::max(std::ceil(left), 0.0);
        const double last = std::min(std::floor(right), static_cast<double>(width - 1));
        if (!(first <= last)) return;
        const auto begin = pixels.begin() + static_cast<std::ptrdiff_t>(row) * width;
        std::fill(begin + static_cast<std::ptrdiff_t>(first),
                  begin + static_cast<std::ptrdiff_t>(last) + 1,
                  1);
    }
};

// Returns x of the edge at height y, computed from its lower end for either direction.
double edge_x(Point a, Point b, double y) {
    if (a.y() > b.y()) std::swap(a, b);
    return a.x() + (b.x() - a.x()) * ((y - a.y()) / (b.y() - a.y()));
}

// Fills pixels whose centres lie in the convex polygon or within kTolerance_px of it.
void fill_convex(std::span<const Point> polygon, Raster& raster) {
    double low = polygon[0].y();
    double high = low;
    for (const Point& p : polygon) {
        low = std::min(low, p.y());
        high = std::max(high, p.y());
    }
    low = std::max(std::ceil(low - kTolerance_px), 0.0);
    high = std::min(std::floor(high + kTolerance_px), static_cast<double>(raster.height - 1));
    for (double row = low; row <= high; ++row) {
        double left = std::numeric_limits<double>::infinity();
        double right = -left;
        // in the strip row +- tolerance the polygon extends as far as its corners there
        for (std::size_t i = 0, j = polygon.size() - 1; i < polygon.size(); j = i++) {
            const Point& a = polygon[j];
            const Point& b = polygon[i];
            if (std::abs(a.y() - row) <= kTolerance_px) {
                left = std::min(left, a.x());
                right = std::max(right, a.x());
            }
            for (const double y : {row - kTolerance_px, row + kTolerance_px}) {
                if ((a.y() < y) == (b.y() < y)) continue;
                const double x = edge_x(a, b, y);
                left = std::min(left, x);
                right = std::max(right, x);
            }
        }
        if (left <= right)
            raster.fill(static_cast<int>(row), left - kTolerance_px, right + kTolerance_px);
    }
}

// Fills by the even-odd rule at the pixel centres of each row, shifted by `dy`; widens spans by
// `widen` on both sides.
void fill_even_odd(const std::vector<std::vector<Point>>& contours,
                   double dy,
                   double widen,
                   Raster& raster) {
    std::vector<std::vector<double>> crossings(static_cast<std::size_t>(raster.height));
    for (const std::vector<Point>& contour : contours) {
        for (std::size_t i = 0, j = contour.size() - 1; i < contour.size(); j = i++) {
            const double low = std::min(contour[i].y(), contour[j].y()) - dy;
            const double high = std::max(contour[i].y(), contour[j].y()) - dy;
            // rows with low <= row < high
            const double first = std::max(std::ceil(low), 0.0);
            const double last =
                std::min(std::ceil(high) - 1.0, static_cast<double>(raster.height - 1));
            for (double row = first; row <= last; ++row) {
                crossings[static_cast<std::size_t>(row)].push_back(
                    edge_x(contour[j], contour[i], row + dy));
            }
        }
    }
    for (int row = 0; row < raster.height; ++row) {
        std::vector<double>& xs = crossings[static_cast<std::size_t>(row)];
        std::sort(xs.begin(), xs.end());
        for (std::size_t i = 0; i + 1 < xs.size(); i += 2)
            raster.fill(row, xs[i] - widen, xs[i + 1] + widen);
    }
}

void draw_mesh(const geometry::TriangleMesh& mesh,
               const hull::SilhouetteView& view,
               Raster& raster) {
    std::array<Point, 4> polygon;
    for (const auto& triangle : mesh.triangles) {
        std::array<Eigen::Vector3d, 3> p;
        for (std::size_t k = 0; k < 3; ++k)
            p[k] = view.camera_from_site * mesh.vertices[triangle[k]];
        std::size_t count = 0;
        for (std::size_t k = 0; k < 3; ++k) {
            const Eigen::Vector3d& a = p[k];
            const Eigen::Vector3d& b = p[(k + 1) % 3];
            if (a.z() >= kNear_m) polygon[count++] = view.intrinsics.project(a);
            if ((a.z() >= kNear_m) != (b.z() >= kNear_m)) {
                Eigen::Vector3d cut = a + (b - a) * ((kNear_m - a.z()) / (b.z() - a.z()));
                cut.z() = kNear_m;
                polygon[count++] = view.intrinsics.project(cut);
            }
        }
        if (count >= 3) fill_convex({polygon.data(), count}, raster);
    }
}

}  // namespace

Coverage measure_coverage(const geometry::TriangleMesh& mesh,
                          const hull::SilhouetteView& view,
                          CoverageScratch& scratch) {
    const int width = view.intrinsics.width;
    const int height = view.intrinsics.height;
    const std::size_t num_pixels =
        static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
    for (auto* pixels : {&scratch.silhouette, &scratch.near_silhouette, &scratch.hull})
        pixels->assign(num_pixels, 0);
    Raster silhouette{scratch.silhouette, width, height};
    Raster near_silhouette{scratch.near_silhouette, width, height};
    Raster hull{scratch.hull, width, height};
    fill_even_odd(view.contours, 0.0, 0.0, silhouette);
    // twice the tolerance, since the hull is drawn with one as well
    for (const double dy : {-2.0, -1.0, 0.0, 1.0, 2.0}) {
        fill_even_odd(view.contours, dy * kTolerance_px, 2.0 * kTolerance_px, near_silhouette);
    }
    draw_mesh(mesh, view, hull);
    scratch.field.assign(num_pixels, view.field.empty() ? 1 : 0);
    if (!view.field.empty()) {
        Raster field{scratch.field, width, height};
        fill_even_odd({view.field}, 0.0, 0.0, field);
    }
    Coverage coverage;
    for (std::size_t i = 0; i < num_pixels; ++i) {
        if (scratch.field[i] == 0) continue;
        coverage.silhouette_px += scratch.silhouette[i];
        coverage.covered_px += scratch.silhouette[i] & scratch.hull[i];
        coverage.excess_px += scratch.hull[i] & ~scratch.near_silhouette[i] & 1u;
    }
    return coverage;
}

}  // namespace atrium::hull_tool
