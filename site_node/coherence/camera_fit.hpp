#pragma once

#include "site_node/coherence/tangency.hpp"

#include <Eigen/Core>

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace atrium::coherence {

/// What may be wrong with one camera: 3 numbers of a turn about its centre [rad], 3 of a motion of
/// its centre [m], both site axes, the dilation of its silhouettes [px], and how late its pictures
/// are [instants].
using Fault = Eigen::Matrix<double, 8, 1>;
inline constexpr int kFirstTurn = 0, kFirstMove = 3, kDilated = 6, kDelay = 7;

/// Which of these are free; the others stay zero.
enum class Freedom : std::uint8_t { kDilation, kTurn, kMove, kPose, kLate, kAll };

/// How a fault explains the tangencies of a camera.
struct CameraFit {
    Fault fault = Fault::Zero();
    /// Decrease of the robust cost against no fault, a tangency of `scale_px` counting about one.
    double gain = 0.0;
    /// The same of each block of instants, by the fault that the other blocks find.
    std::vector<double> held_out_gains;
    Fault deviation = Fault::Zero();                 // of `fault`, by leaving blocks out
    double rms_before_px = 0.0, rms_after_px = 0.0;  // robust
    double effect_px = 0.0;  // RMS of what a pose or lateness of the fault does to the tangencies
    double effect_deviation_px = 0.0;
};

/// Robust fits of one camera after the other, with the others fixed.
class CameraFitter {
public:
    /// `dilations_px`: of each camera, subtracted first. `num_blocks`: of equally many instants.
    CameraFitter(std::span<const Tangency> tangencies,
                 std::span<const double> dilations_px,
                 std::uint32_t num_sights,
                 double scale_px);

    CameraFit fit(std::uint32_t camera, Freedom freedom) const;

    static constexpr std::size_t kBlocks = 6;

private:
    std::span<const Tangency> tangencies_;
    std::span<const double> dilations_px_;
    std::uint32_t num_sights_;
    double scale_px_;
};

/// Estimates how much larger each camera's silhouettes are than those of the others [px]: a
/// segmentation that is tighter or wider must not look like a moved camera.
std::vector<double> find_dilations(std::span<const Tangency> tangencies, std::size_t num_cameras);

/// The error of a tangency without the dilations [px].
double error_without(const Tangency& tangency, std::span<const double> dilations_px);

/// 1.48 times the median of absolute values: the standard deviation of most of them. 0 of none.
double robust_deviation(std::vector<double> values);

}  // namespace atrium::coherence
