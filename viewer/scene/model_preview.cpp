#include "viewer/scene/model_preview.hpp"

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace atrium::viewer {
namespace {

constexpr double kMargin_px = 3.0;
constexpr double kDarkest = 60.0;
constexpr double kBrightest = 250.0;
constexpr double kGreyStep = 8.0;  // few greys make long runs of equal ones

// Axes of the picture: right, up, towards the eye.
Eigen::Matrix3d picture_axes() {
    const Eigen::Vector3d towards = Eigen::Vector3d(0.55, -1.0, 0.6).normalized();
    const Eigen::Vector3d right = Eigen::Vector3d::UnitZ().cross(towards).normalized();
    Eigen::Matrix3d axes;
    axes << right.transpose(), towards.cross(right).transpose(), towards.transpose();
    return axes;
}

struct Canvas {
    ModelPreview& preview;
    std::vector<double> depths;

    /// Fills a triangle of picture coordinates [px] and depths; larger ones are nearer.
    void fill(const std::array<Eigen::Vector3d, 3>& corners, std::uint8_t grey) {
        const auto& [a, b, c] = corners;
        const auto cross =
            [](const Eigen::Vector3d& p, const Eigen::Vector3d& q, double x, double y) {
                return (q.x() - p.x()) * (y - p.y()) - (q.y() - p.y()) * (x - p.x());
            };
        const double area = cross(a, b, c.x(), c.y());
        if (std::abs(area) < 1e-12) return;
        const auto [left, right] = std::minmax({a.x(), b.x(), c.x()});
        const auto [top, bottom] = std::minmax({a.y(), b.y(), c.y()});
        const int last_x = std::min(ModelPreview::kWidth - 1, static_cast<int>(right));
        const int last_y = std::min(ModelPreview::kHeight - 1, static_cast<int>(bottom));
        for (int y = std::max(0, static_cast<int>(top)); y <= last_y; ++y) {
            for (int x = std::max(0, static_cast<int>(left)); x <= last_x; ++x) {
                const double u = cross(b, c, x + 0.5, y + 0.5) / area;
                const double v = cross(c, a, x + 0.5, y + 0.5) / area;
                if (u < 0.0 || v < 0.0 || u + v > 1.0) continue;
                const double depth = u * a.z() + v * b.z() + (1.0 - u - v) * c.z();
                const auto at = static_cast<std::size_t>(y * ModelPreview::kWidth + x);
                if (depth <= depths[at]) continue;
                depths[at] = depth;
                preview.greys[at] = grey;
            }
        }
    }
};

}  // namespace

ModelPreview draw_preview(const std::vector<model::ModelPart>& parts) {
    const Eigen::Matrix3d axes = picture_axes();
    Eigen::AlignedBox3d bounds;
    for (const model::ModelPart& part : parts)
        for (const Eigen::Vector3d& vertex : part.mesh.vertices) bounds.extend(axes * vertex);
    if (bounds.isEmpty() || !bounds.sizes().allFinite()) return {};
    const Eigen::Vector2d size = bounds.sizes().head<2>();
    if (!(size.maxCoeff() > 0.0)) return {};
    const double scale = std::min((ModelPreview::kWidth - 2.0 * kMargin_px) / size.x(),
                                  (ModelPreview::kHeight - 2.0 * kMargin_px) / size.y());
    const auto in_picture = [&](const Eigen::Vector3d& vertex) -> Eigen::Vector3d {
        const Eigen::Vector3d from_middle = scale * (axes * vertex - bounds.center());
        return {0.5 * ModelPreview::kWidth + from_middle.x(),
                0.5 * ModelPreview::kHeight - from_middle.y(),
                from_middle.z()};
    };
    const Eigen::Vector3d light = Eigen::Vector3d(0.2, -0.5, 0.9).normalized();
    constexpr std::size_t kNumPixels = std::size_t{ModelPreview::kWidth} * ModelPreview::kHeight;
    ModelPreview preview{std::vector<std::uint8_t>(kNumPixels, ModelPreview::kBackground)};
    Canvas canvas{preview,
                  std::vector<double>(kNumPixels, -std::numeric_limits<double>::infinity())};
    for (const model::ModelPart& part : parts) {
        for (const auto& triangle : part.mesh.triangles) {
            std::array<Eigen::Vector3d, 3> corners;
            for (int i = 0; i < 3; ++i)
                corners[static_cast<std::size_t>(i)] =
                    part.mesh.vertices[static_cast<std::size_t>(triangle[i])];
            // as the viewer draws models: from both sides
            Eigen::Vector3d normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
            if (normal.dot(axes.row(2)) < 0.0) normal = -normal;
            const double lit = std::max(0.0, normal.normalized().dot(light));
            const double grey = kDarkest + (kBrightest - kDarkest) * lit;
            for (Eigen::Vector3d& corner : corners) corner = in_picture(corner);
            canvas.fill(corners,
                        static_cast<std::uint8_t>(kGreyStep * std::floor(grey / kGreyStep)));
        }
    }
    return preview;
}

}  // namespace atrium::viewer
