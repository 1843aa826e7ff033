#include "tools/calibrate/formats/lens_fit.hpp"

#include "core/geometry/alignment.hpp"

#include <cmath>
#include <numbers>
#include <vector>

namespace atrium::calibrate {
namespace {

struct Pair {
    Eigen::Vector2d straight;
    Eigen::Vector2d distorted;
};

// Brown's model is linear in its coefficients.
LensFit fit_pairs(const geometry::PinholeCamera& camera, const std::vector<Pair>& pairs) {
    Eigen::MatrixXd a(2 * static_cast<Eigen::Index>(pairs.size()), 5);
    Eigen::VectorXd b(a.rows());
    Eigen::Index row = 0;
    for (const Pair& pair : pairs) {
        const double x = pair.straight.x();
        const double y = pair.straight.y();
        const double r2 = x * x + y * y;
        a.row(row) << x * r2, x * r2 * r2, 2 * x * y, r2 + 2 * x * x, x * r2 * r2 * r2;
        a.row(row + 1) << y * r2, y * r2 * r2, r2 + 2 * y * y, 2 * x * y, y * r2 * r2 * r2;
        b.segment<2>(row) = pair.distorted - pair.straight;
        row += 2;
    }
    LensFit fit;
    if (pairs.size() < 5) return fit;
    const Eigen::VectorXd c = geometry::solve_least_squares(a, b);
    for (int i = 0; i < 5; ++i) fit.distortion[static_cast<std::size_t>(i)] = c[i];
    const Eigen::VectorXd residual = a * c - b;
    for (Eigen::Index i = 0; i < residual.size(); i += 2) {
        const Eigen::Vector2d px(camera.fx * residual[i], camera.fy * residual[i + 1]);
        fit.error_px = std::max(fit.error_px, px.norm());
    }
    return fit;
}

}  // namespace

LensFit fit_lens(const geometry::PinholeCamera& camera, const Distort& distort) {
    constexpr int kDirections = 32;
    constexpr double kStep = 0.02;
    constexpr double kFarthest = 10.0;  // 84 degrees from the axis
    std::vector<Pair> pairs;
    for (int i = 0; i < kDirections; ++i) {
        const double angle = 2.0 * std::numbers::pi * i / kDirections;
        const Eigen::Vector2d direction(std::cos(angle), std::sin(angle));
        double former = 0.0;
        for (double radius = kStep; radius < kFarthest; radius *= 1.08) {
            const Eigen::Vector2d straight = radius * direction;
            const Eigen::Vector2d distorted = distort(straight);
            const double reach = distorted.dot(direction);
            const double u = camera.fx * distorted.x() + camera.cx;
            const double v = camera.fy * distorted.y() + camera.cy;
            // the picture ends here, or the model folds back
            if (!(reach > former) || u < -0.5 || v < -0.5 || u > camera.width - 0.5 ||
                v > camera.height - 0.5)
                break;
            former = reach;
            pairs.push_back({straight, distorted});
        }
    }
    return fit_pairs(camera, pairs);
}

LensFit fit_lens_inverse(const geometry::PinholeCamera& camera, const Distort& straighten) {
    constexpr int kSteps = 24;
    std::vector<Pair> pairs;
    for (int i = 0; i < kSteps * kSteps; ++i) {
        const Eigen::Vector2d pixel((i % kSteps) * (camera.width - 1.0) / (kSteps - 1),
                                    (i / kSteps) * (camera.height - 1.0) / (kSteps - 1));
        const Eigen::Vector2d distorted((pixel.x() - camera.cx) / camera.fx,
                                        (pixel.y() - camera.cy) / camera.fy);
        pairs.push_back({straighten(pixel), distorted});
    }
    return fit_pairs(camera, pairs);
}

Distort rational_lens(std::span<const double> coefficients) {
    std::array<double, 12> k{};
    std::copy_n(coefficients.begin(), std::min<std::size_t>(coefficients.size(), 12), k.begin());
    return [k](const Eigen::Vector2d& p) -> Eigen::Vector2d {
        const double x = p.x();
        const double y = p.y();
        const double r2 = x * x + y * y;
        const double radial = (1 + r2 * (k[0] + r2 * (k[1] + r2 * k[4]))) /
                              (1 + r2 * (k[5] + r2 * (k[6] + r2 * k[7])));
        return {
            x * radial + 2 * k[2] * x * y + k[3] * (r2 + 2 * x * x) + r2 * (k[8] + r2 * k[9]),
            y * radial + k[2] * (r2 + 2 * y * y) + 2 * k[3] * x * y + r2 * (k[10] + r2 * k[11])};
    };
}

Distort equidistant_lens(std::span<const double> coefficients) {
    std::array<double, 4> k{};
    std::copy_n(coefficients.begin(), std::min<std::size_t>(coefficients.size(), 4), k.begin());
    return [k](const Eigen::Vector2d& p) -> Eigen::Vector2d {
        const double r = p.norm();
        if (r < 1e-9) return p;
        const double t = std::atan(r);
        const double t2 = t * t;
        const double bent = t * (1 + t2 * (k[0] + t2 * (k[1] + t2 * (k[2] + t2 * k[3]))));
        return p * (bent / r);
    };
}

}  // namespace atrium::calibrate
