#include "tools/calibrate/judge/measured_heights.hpp"

#include "core/geometry/alignment.hpp"
#include "tools/calibrate/judge/angles.hpp"

#include <algorithm>
#include <cmath>

namespace atrium::calibrate {
namespace {

using Centres = std::span<const Eigen::Vector3d>;
using Heights = std::span<const MeasuredHeight>;

// Standard deviation of a height that is measured with a tape.
constexpr double kTape_m = 0.02;
// A tilt comes from the heights if they make it this much more certain than the guess.
constexpr double kFromHeights = 0.5;
// The odd height leaves this share of the cost of the next one.
constexpr double kClearlyOdd = 0.5;
// Of so few heights, any may be the odd one.
constexpr std::size_t kFewHeights = 4;
// Another scale explains the heights if it leaves this share of the deviations.
constexpr double kScaleHelps = 0.3;
constexpr double kOtherScale = 0.02;
// The cameras stand in no plane if they deviate by this from one (root of the mean square).
constexpr double kNoPlane_m = 0.2;
constexpr double kAboutUp = 0.94;  // cosine
constexpr int kMaxSteps = 60;
constexpr double kNoStep = 1e-10;

double mean_floor(Centres centres, Heights heights, const Eigen::Vector3d& up) {
    double sum = 0.0;
    for (const auto& [camera, metres] : heights) sum += centres[camera].dot(up) - metres;
    return sum / static_cast<double>(heights.size());
}

double largest_deviation(Centres centres, Heights heights, const HeightFit& fit) {
    double largest = 0.0;
    for (const auto& [camera, metres] : heights)
        largest = std::max(largest, std::abs(centres[camera].dot(fit.up) - fit.floor_m - metres));
    return largest;
}

// Sum of the squares of all deviations, each in units of its standard deviation.
double cost_of(Centres centres, Heights heights, const UpGuess& guess, const Eigen::Vector3d& up) {
    const double floor_m = mean_floor(centres, heights, up);
    double cost = (up - guess.up).squaredNorm() / std::pow(guess.error_deg / kDegreesPerRad, 2);
    for (const auto& [camera, metres] : heights)
        cost += std::pow((centres[camera].dot(up) - floor_m - metres) / kTape_m, 2);
    return cost;
}

// Two directions perpendicular to `up`.
Eigen::Matrix<double, 3, 2> tilts_of(const Eigen::Vector3d& up) {
    Eigen::Matrix<double, 3, 2> tilts;
    tilts.col(0) = up.unitOrthogonal();
    tilts.col(1) = up.cross(tilts.col(0));
    return tilts;
}

// The normal equations of the tilts about `up`; the floor is the mean.
struct Normal {
    Eigen::Matrix2d information;
    Eigen::Vector2d gradient;
};
Normal normal_at(Centres centres,
                 Heights heights,
                 const UpGuess& guess,
                 const Eigen::Vector3d& up) {
    const Eigen::Matrix<double, 3, 2> tilts = tilts_of(up);
    const double floor_m = mean_floor(centres, heights, up);
    Eigen::Vector3d mean = Eigen::Vector3d::Zero();
    for (const auto& height : heights)
        mean += centres[height.camera] / static_cast<double>(heights.size());
    const double guessed = std::pow(kDegreesPerRad / guess.error_deg, 2);
    Normal normal{guessed * Eigen::Matrix2d::Identity(),
                  guessed * tilts.transpose() * (up - guess.up)};
    for (const auto& [camera, metres] : heights) {
        const Eigen::Vector2d row = tilts.transpose() * (centres[camera] - mean) / kTape_m;
        normal.information += row * row.transpose();
        normal.gradient += row * (centres[camera].dot(up) - floor_m - metres) / kTape_m;
    }
    return normal;
}

}  // namespace

HeightFit fit_heights(Centres centres, Heights heights, const UpGuess& guess) {
    HeightFit fit;
    fit.up = guess.up;
    double cost = cost_of(centres, heights, guess, fit.up);
    double damping = 1e-3;  // Levenberg and Marquardt
    for (int i = 0; i < kMaxSteps; ++i) {
        const Normal normal = normal_at(centres, heights, guess, fit.up);
        Eigen::Matrix2d damped = normal.information;
        damped.diagonal() *= 1.0 + damping;
        const Eigen::Vector2d step = -damped.inverse() * normal.gradient;
        if (step.norm() < kNoStep) break;
        const Eigen::Vector3d up = (fit.up + tilts_of(fit.up) * step).normalized();
        const double new_cost = cost_of(centres, heights, guess, up);
        damping *= new_cost < cost ? 0.2 : 8.0;
        if (new_cost >= cost) continue;
        fit.up = up;
        cost = new_cost;
    }
    fit.floor_m = mean_floor(centres, heights, fit.up);
    fit.deviation_m = largest_deviation(centres, heights, fit);
    const double least =
        geometry::eigenvalues_of(normal_at(centres, heights, guess, fit.up).information)[0];
    fit.error_deg = kDegreesPerRad / std::sqrt(least);
    fit.has_both_tilts = fit.error_deg < kFromHeights * guess.error_deg;
    return fit;
}

HeightFit fit_floor(Centres centres, Heights heights, const Eigen::Vector3d& up) {
    HeightFit fit;
    fit.up = up;
    fit.floor_m = mean_floor(centres, heights, up);
    fit.deviation_m = largest_deviation(centres, heights, fit);
    return fit;
}

std::optional<OddHeight> odd_height(Centres centres, Heights heights, const UpGuess& guess) {
    if (heights.size() < 3) return std::nullopt;
    std::vector<double> costs;
    std::vector<double> others_say;
    for (std::size_t i = 0; i < heights.size(); ++i) {
        std::vector<MeasuredHeight> others(heights.begin(), heights.end());
        others.erase(others.begin() + static_cast<std::ptrdiff_t>(i));
        const HeightFit fit = fit_heights(centres, others, guess);
        costs.push_back(cost_of(centres, others, guess, fit.up));
        others_say.push_back(centres[heights[i].camera].dot(fit.up) - fit.floor_m);
    }
    const auto best = static_cast<std::size_t>(std::ranges::min_element(costs) - costs.begin());
    const auto num_odd = std::ranges::count_if(
        costs, [&](double cost) { return costs[best] >= kClearlyOdd * cost; });
    return OddHeight{best, num_odd == 1 && heights.size() > kFewHeights, others_say[best]};
}

std::optional<double> scale_of_heights(Centres centres,
                                       Heights heights,
                                       const Eigen::Vector3d& up) {
    const auto num = static_cast<Eigen::Index>(heights.size());
    if (num < 4) return std::nullopt;
    Eigen::MatrixXd places(num, 3);
    Eigen::VectorXd metres(num);
    for (Eigen::Index i = 0; i < num; ++i) {
        const MeasuredHeight& height = heights[static_cast<std::size_t>(i)];
        places.row(i) = centres[height.camera].transpose();
        metres[i] = height.metres;
    }
    places.rowwise() -= places.colwise().mean().eval();
    metres.array() -= metres.mean();
    const Eigen::Matrix3d squares = places.transpose() * places;
    if (geometry::principal_axes(squares).values[0] <
        kNoPlane_m * kNoPlane_m * static_cast<double>(num))
        return std::nullopt;
    const Eigen::Vector3d scaled_up = geometry::solve_least_squares(places, metres);
    const double scale = scaled_up.norm();
    if (std::abs(scale - 1.0) < kOtherScale || scaled_up.dot(up) < kAboutUp * scale)
        return std::nullopt;
    const double left = (places * scaled_up - metres).norm();
    return left < kScaleHelps * (places * up - metres).norm() ? std::optional(scale) : std::nullopt;
}

}  // namespace atrium::calibrate
