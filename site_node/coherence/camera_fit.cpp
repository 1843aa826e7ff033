#include "site_node/coherence/camera_fit.hpp"

#include "core/geometry/alignment.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace atrium::coherence {
namespace {

using Normal = Eigen::Matrix<double, 8, 8>;

// Standard deviations of faults that are expected at all: they hold what silhouettes do not show.
const Fault kExpected = [] {
    Fault expected;
    expected << 0.02, 0.02, 0.02, 0.05, 0.05, 0.05, 0.7, 2.0;
    return expected;
}();
constexpr double kExpectedDilation_px = 1.0;
constexpr int kIterations = 12;
constexpr double kLeastDeviation_px = 0.2;

// Cost and weight of an error, after Geman and McClure: gross errors count nothing.
double cost_of(double error) { return error * error / (1.0 + error * error); }
double weight_of(double error) {
    const double w = 1.0 / (1.0 + error * error);
    return w * w;
}

bool is_free(Freedom freedom, int i) {
    switch (freedom) {
        case Freedom::kDilation:
            return i == kDilated;
        case Freedom::kTurn:
            return i < kFirstMove || i == kDilated;
        case Freedom::kMove:
            return i >= kFirstMove && i <= kDilated;
        case Freedom::kPose:
            return i <= kDilated;
        case Freedom::kLate:
            return i >= kDilated;
        case Freedom::kAll:
            return true;
    }
    return false;
}

// A tangency as an equation of one camera: error + derivative * fault = 0.
struct Equation {
    Fault derivative;
    double error = 0.0;
    std::size_t block = 0;
};

std::vector<Equation> equations_of(std::span<const Tangency> tangencies,
                                   std::span<const double> dilations_px,
                                   std::uint32_t num_sights,
                                   std::uint32_t camera,
                                   Freedom freedom) {
    std::vector<Equation> equations;
    for (const Tangency& t : tangencies) {
        const bool is_first = t.ends[0].camera == camera;
        if (!is_first && t.ends[1].camera != camera) continue;
        const TangentEnd& end = t.ends[is_first ? 0 : 1];
        Equation equation;
        equation.error = error_without(t, dilations_px);
        equation.derivative << end.by_turn, end.by_move, end.by_dilation, 0.0;
        // pictures that are late show a plane that lags behind
        if (std::isfinite(t.motion_px))
            equation.derivative[kDelay] = is_first ? t.motion_px : -t.motion_px;
        for (int i = 0; i < 8; ++i)
            if (!is_free(freedom, i)) equation.derivative[i] = 0.0;
        equation.block = std::min<std::size_t>(
            CameraFitter::kBlocks - 1,
            t.sight * CameraFitter::kBlocks / std::max<std::uint32_t>(num_sights, 1));
        equations.push_back(equation);
    }
    return equations;
}

struct Sums {
    Normal normal = Normal::Zero();
    Fault right = Fault::Zero();
    Fault solve() const {
        Normal with_prior = normal;
        with_prior.diagonal() += kExpected.cwiseAbs2().cwiseInverse();
        return geometry::solve_symmetric(with_prior, -right);
    }
};

using Blocks = std::array<Sums, CameraFitter::kBlocks>;

Sums sum_of(const Blocks& blocks) {
    Sums sum;
    for (const Sums& block : blocks) {
        sum.normal += block.normal;
        sum.right += block.right;
    }
    return sum;
}

Blocks weigh(const std::vector<Equation>& equations, const Fault& fault, double scale_px) {
    Blocks blocks;
    for (const Equation& equation : equations) {
        const double error = equation.error + equation.derivative.dot(fault);
        const double weight = weight_of(error / scale_px) / (scale_px * scale_px);
        Sums& block = blocks[equation.block];
        block.normal += weight * equation.derivative * equation.derivative.transpose();
        block.right += weight * equation.error * equation.derivative;
    }
    return blocks;
}

std::vector<double> errors_of(const std::vector<Equation>& equations, const Fault& fault) {
    std::vector<double> errors;
    for (const Equation& equation : equations)
        errors.push_back(equation.error + equation.derivative.dot(fault));
    return errors;
}

double effect_of(const std::vector<Equation>& equations, const Fault& fault) {
    Fault without = fault;
    without[kDilated] = 0.0;
    double sum = 0.0;
    for (const Equation& equation : equations) sum += std::pow(equation.derivative.dot(without), 2);
    return equations.empty() ? 0.0 : std::sqrt(sum / static_cast<double>(equations.size()));
}

}  // namespace

double robust_deviation(std::vector<double> values) {
    if (values.empty()) return 0.0;
    for (double& value : values) value = std::abs(value);
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return 1.4826 * *middle;
}

double error_without(const Tangency& t, std::span<const double> dilations_px) {
    return t.error_px - t.ends[0].by_dilation * dilations_px[t.ends[0].camera] -
           t.ends[1].by_dilation * dilations_px[t.ends[1].camera];
}

std::vector<double> find_dilations(std::span<const Tangency> tangencies, std::size_t num_cameras) {
    std::vector<double> dilations(num_cameras, 0.0);
    std::vector<double> errors;
    for (const Tangency& t : tangencies) errors.push_back(t.error_px);
    const double scale = std::max(kLeastDeviation_px, robust_deviation(std::move(errors)));
    const auto n = static_cast<Eigen::Index>(num_cameras);
    for (int i = 0; i < kIterations; ++i) {
        Eigen::MatrixXd normal =
            Eigen::MatrixXd::Identity(n, n) / (kExpectedDilation_px * kExpectedDilation_px);
        Eigen::VectorXd right = Eigen::VectorXd::Zero(n);
        for (const Tangency& t : tangencies) {
            const double weight =
                weight_of(error_without(t, dilations) / (2.0 * scale)) / (scale * scale);
            for (const TangentEnd& row : t.ends) {
                right[row.camera] += weight * row.by_dilation * t.error_px;
                for (const TangentEnd& column : t.ends)
                    normal(row.camera, column.camera) +=
                        weight * row.by_dilation * column.by_dilation;
            }
        }
        const Eigen::VectorXd solved = geometry::solve_symmetric(normal, right);
        for (Eigen::Index c = 0; c < n; ++c) dilations[static_cast<std::size_t>(c)] = solved[c];
    }
    return dilations;
}

CameraFitter::CameraFitter(std::span<const Tangency> tangencies,
                           std::span<const double> dilations_px,
                           std::uint32_t num_sights,
                           double scale_px)
    : tangencies_(tangencies),
      dilations_px_(dilations_px),
      num_sights_(num_sights),
      scale_px_(scale_px) {}

CameraFit CameraFitter::fit(std::uint32_t camera, Freedom freedom) const {
    const std::vector<Equation> equations =
        equations_of(tangencies_, dilations_px_, num_sights_, camera, freedom);
    CameraFit fit;
    fit.held_out_gains.assign(kBlocks, 0.0);
    const double deviation = robust_deviation(errors_of(equations, Fault::Zero()));
    fit.rms_before_px = fit.rms_after_px = deviation;
    if (equations.empty()) return fit;

    // the scale shrinks from that of the errors as they are
    double scale = std::max(scale_px_, 3.0 * deviation);
    Blocks blocks;
    for (int i = 0; i < kIterations; ++i) {
        blocks = weigh(equations, fit.fault, scale);
        fit.fault = sum_of(blocks).solve();
        scale = std::max(scale_px_, 0.7 * scale);
    }
    const Sums all = sum_of(blocks);
    std::array<Fault, kBlocks> without;
    Fault mean = Fault::Zero();
    for (std::size_t b = 0; b < kBlocks; ++b) {
        without[b] = Sums{all.normal - blocks[b].normal, all.right - blocks[b].right}.solve();
        mean += without[b] / static_cast<double>(kBlocks);
    }
    Fault variance = Fault::Zero();
    double effect_variance = 0.0;
    constexpr double kJackknife = (kBlocks - 1.0) / kBlocks;
    for (const Fault& one : without) {
        variance += kJackknife * (one - mean).cwiseAbs2();
        effect_variance += kJackknife * std::pow(effect_of(equations, one - mean), 2);
    }
    fit.deviation = variance.cwiseSqrt();
    fit.effect_deviation_px = std::sqrt(effect_variance);
    fit.effect_px = effect_of(equations, fit.fault);
    fit.rms_after_px = robust_deviation(errors_of(equations, fit.fault));
    for (const Equation& e : equations) {
        const double before = cost_of(e.error / scale_px_);
        fit.gain += before - cost_of((e.error + e.derivative.dot(fit.fault)) / scale_px_);
        fit.held_out_gains[e.block] +=
            before - cost_of((e.error + e.derivative.dot(without[e.block])) / scale_px_);
    }
    return fit;
}

}  // namespace atrium::coherence
