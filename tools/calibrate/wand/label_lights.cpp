#include "tools/calibrate/wand/label_lights.hpp"

#include "core/geometry/alignment.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace atrium::calibrate {
namespace {

constexpr std::size_t kMaxPoints = 24;
constexpr double kShortest_px = 8.0;
// Of a point beside its place: noise, and what a lens bends a line of this length.
constexpr double kNoise_px = 1.2;
constexpr double kBent = 0.012;
// |log of the ratio of the depths of a line's ends|: 60 cm may point at a camera 1.2 m away.
constexpr double kMaxTurn = 0.7;
constexpr double kClearTurn = 0.3;  // one direction needs so much less than the other
// Errors of another set of points that make the choice a guess.
constexpr double kClearError = 3.0, kSmallError_px = 1.0;
// Of a body, in units of its size in the picture: perspective is no affine map.
constexpr double kNotAffine = 0.12, kClearlyNotAffine = 0.08;

double cross(const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
    return a.x() * b.y() - a.y() * b.x();
}

bool are_same_set(std::vector<std::size_t> a, std::vector<std::size_t> b) {
    std::ranges::sort(a);
    std::ranges::sort(b);
    return a == b;
}

// Of three lights with the largest triangle.
std::vector<std::size_t> widest_triangle(const std::vector<Eigen::Vector3d>& lights) {
    std::vector<std::size_t> widest{0, 1, 2};
    double most = -1.0;
    for (std::size_t i = 0; i < lights.size(); ++i) {
        for (std::size_t j = i + 1; j < lights.size(); ++j) {
            for (std::size_t k = j + 1; k < lights.size(); ++k) {
                const double area = (lights[j] - lights[i]).cross(lights[k] - lights[i]).norm();
                if (area <= most) continue;
                most = area;
                widest = {i, j, k};
            }
        }
    }
    return widest;
}

}  // namespace

std::optional<LightLabeller> LightLabeller::make(const Wand& wand) {
    LightLabeller labeller(wand);
    const std::size_t n = wand.size();
    labeller.places_.assign(n, 0.0);
    if (wand.form() == WandForm::kPoint) {
        labeller.order_ = {0};
        return labeller;
    }
    if (wand.form() == WandForm::kLine) {
        labeller.places_ = wand.places_on_line_m();
        labeller.order_.resize(n);
        std::iota(labeller.order_.begin(), labeller.order_.end(), std::size_t{0});
        std::ranges::sort(labeller.order_, {}, [&](std::size_t i) { return labeller.places_[i]; });
        std::rotate(labeller.order_.begin() + 1, labeller.order_.end() - 1, labeller.order_.end());
        const double start = labeller.places_[labeller.order_[0]];
        const double length = labeller.places_[labeller.order_[1]] - start;
        for (double& place : labeller.places_) place = (place - start) / length;
    } else {
        labeller.order_ = widest_triangle(wand.lights_m);
        for (std::size_t i = 0; i < n; ++i)
            if (std::ranges::find(labeller.order_, i) == labeller.order_.end())
                labeller.order_.push_back(i);
    }
    if (!labeller.tells_itself()) return std::nullopt;
    return labeller;
}

// Labels pictures of the wand from two sides.
bool LightLabeller::tells_itself() const {
    const double scale = 300.0 / wand_.length_m();
    for (const double slant : {0.3, -0.4}) {
        Eigen::Matrix<double, 2, 3> px_from_wand;
        px_from_wand << 1.0, slant, 0.7, 0.5 * slant, 1.0, -0.6;
        std::vector<Eigen::Vector2d> points;
        for (const Eigen::Vector3d& light : wand_.lights_m)
            points.emplace_back(scale * px_from_wand * light);
        const auto labels = label(points);
        if (!labels) return false;
        for (std::size_t i = 0; i < labels->size(); ++i)
            if ((*labels)[i] != i) return false;
    }
    return true;
}

std::optional<std::vector<std::size_t>> LightLabeller::label(
    std::span<const Eigen::Vector2d> points) const {
    if (points.size() < wand_.size() || points.size() > kMaxPoints) return std::nullopt;
    if (order_.size() == 1)
        return points.size() == 1 ? std::optional(std::vector<std::size_t>{0}) : std::nullopt;
    std::vector<Candidate> found;
    const bool is_line = wand_.form() == WandForm::kLine;
    is_line ? find_lines(points, found) : find_bodies(points, found);
    if (found.empty()) return std::nullopt;
    const auto best = std::ranges::min_element(found, [](const auto& a, const auto& b) {
        return are_same_set(a.points, b.points) && a.turn != b.turn ? a.turn < b.turn
                                                                    : a.error_px < b.error_px;
    });
    for (auto other = found.begin(); other != found.end(); ++other) {
        if (other == best) continue;
        const bool is_clear =
            is_line && are_same_set(other->points, best->points)
                ? other->turn > best->turn + kClearTurn
            : is_line ? other->error_px > std::max(kSmallError_px, kClearError * best->error_px)
                      : other->error_px > best->error_px + kClearlyNotAffine;
        if (!is_clear) return std::nullopt;
    }
    return best->points;
}

void LightLabeller::find_lines(std::span<const Eigen::Vector2d> points,
                               std::vector<Candidate>& found) const {
    const std::size_t n = wand_.size();
    if (n < 3) return;
    const auto try_ends = [&](std::size_t a, std::size_t b) {
        const Eigen::Vector2d way = points[b] - points[a];
        const double length = way.norm();
        if (length < kShortest_px) return;
        const Eigen::Vector2d along = way / length;
        const double most_px = kNoise_px + kBent * length;
        const auto off_px = [&](std::size_t p) { return cross(along, points[p] - points[a]); };
        const auto place = [&](std::size_t p) { return along.dot(points[p] - points[a]) / length; };
        const double first = places_[order_[2]];
        for (std::size_t p = 0; p < points.size(); ++p) {
            if (p == a || p == b || std::abs(off_px(p)) > most_px) continue;
            const double s = place(p);
            if (s * length < 1.0 || (1.0 - s) * length < 1.0) continue;
            const double q = s * (1.0 - first) / (first * (1.0 - s));
            Candidate candidate{std::vector<std::size_t>(n), 0.0, std::abs(std::log(q))};
            if (candidate.turn > kMaxTurn) continue;
            candidate.points[order_[0]] = a;
            candidate.points[order_[1]] = b;
            candidate.points[order_[2]] = p;
            double sum = off_px(p) * off_px(p);
            bool is_complete = true;
            for (std::size_t k = 3; k < n && is_complete; ++k) {
                const double t = places_[order_[k]];
                const double wanted = t * q / (1.0 + t * (q - 1.0));
                double nearest = std::numeric_limits<double>::infinity();
                for (std::size_t r = 0; r < points.size(); ++r) {
                    if (r == a || r == b || r == p) continue;
                    const double error = std::hypot((place(r) - wanted) * length, off_px(r));
                    if (error >= nearest) continue;
                    nearest = error;
                    candidate.points[order_[k]] = r;
                }
                is_complete = nearest <= most_px;
                sum += nearest * nearest;
            }
            if (!is_complete) continue;
            candidate.error_px = std::sqrt(sum / static_cast<double>(n - 2));
            found.push_back(std::move(candidate));
        }
    };
    for (std::size_t a = 0; a < points.size(); ++a)
        for (std::size_t b = 0; b < points.size(); ++b)
            if (a != b) try_ends(a, b);
}

// `error_px` is relative to the size of the body here.
void LightLabeller::find_bodies(std::span<const Eigen::Vector2d> points,
                                std::vector<Candidate>& found) const {
    const std::size_t n = wand_.size();
    if (n < 4) return;
    const auto& lights = wand_.lights_m;
    const Eigen::Vector3d origin = lights[order_[0]];
    Eigen::Matrix<double, 3, 2> sides;
    sides << lights[order_[1]] - origin, lights[order_[2]] - origin;
    std::vector<Eigen::Vector2d> shares(n);
    for (std::size_t k = 3; k < n; ++k) {
        const Eigen::Vector3d light = lights[order_[k]] - origin;
        shares[k] = geometry::solve_least_squares(sides, light);
        if ((sides * shares[k] - light).norm() > 0.05 * wand_.length_m()) return;  // not flat
    }
    const auto try_triangle = [&](std::size_t a, std::size_t b, std::size_t c) {
        Eigen::Matrix2d px;
        px << points[b] - points[a], points[c] - points[a];
        const double size =
            std::max({px.col(0).norm(), px.col(1).norm(), (px.col(0) - px.col(1)).norm()});
        // seen from its side, a flat body is a line
        if (size < kShortest_px || std::abs(px.determinant()) < 0.05 * size * size) return;
        Candidate candidate{std::vector<std::size_t>(n), 0.0, 0.0};
        candidate.points[order_[0]] = a;
        candidate.points[order_[1]] = b;
        candidate.points[order_[2]] = c;
        for (std::size_t k = 3; k < n; ++k) {
            const Eigen::Vector2d wanted = points[a] + px * shares[k];
            double nearest = std::numeric_limits<double>::infinity();
            for (std::size_t r = 0; r < points.size(); ++r) {
                if (r == a || r == b || r == c) continue;
                const double error = (points[r] - wanted).norm() / size;
                if (error >= nearest) continue;
                nearest = error;
                candidate.points[order_[k]] = r;
            }
            if (nearest > kNotAffine) return;
            candidate.error_px = std::max(candidate.error_px, nearest);
        }
        found.push_back(std::move(candidate));
    };
    for (std::size_t a = 0; a < points.size(); ++a)
        for (std::size_t b = 0; b < points.size(); ++b)
            for (std::size_t c = 0; c < points.size(); ++c)
                if (a != b && b != c && a != c) try_triangle(a, b, c);
}

}  // namespace atrium::calibrate
