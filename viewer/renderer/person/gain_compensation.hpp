#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Core>

#include <array>
#include <cstddef>
#include <vector>

namespace atrium::renderer {

struct PersonModel;

struct GainCompensationOptions {
    std::size_t max_points = 600;  // points of the surface to compare; 0: no compensation
    std::size_t min_shared = 16;   // cameras that share fewer points are not compared
    double prior = 0.2;            // expected deviation of a gain from 1, as a logarithm
    double doubt = 0.02;      // deviation of a comparison of two cameras with any number of points
    double dead_zone = 0.01;  // as a logarithm; invisible, and above the noise
};

struct GainCompensationScratch {
    /// [camera][point]; infinite if the camera does not see the point.
    std::vector<Eigen::Array3f> log_colours;
    std::vector<float> differences;
    std::vector<float> deviations;
    std::vector<std::array<double, 3>> weights;  // [camera][camera]
    std::vector<Eigen::Array3d> ratios;          // [camera][camera], logarithms
    Eigen::MatrixXd normal_matrix;
    Eigen::VectorXd solution;
    Eigen::LLT<Eigen::MatrixXd> solver;
    /// Natural logarithm of the gains applied, per camera and channel.
    std::vector<Eigen::Array3d> log_gains;
};

/// Removes colour differences between the cameras with one gain per camera and channel on
/// `model.layers`, so no seam shows where the colours of two cameras meet.
///
/// Compares each pair of cameras at the centres of faces that both see well and takes the median
/// ratio. The gains are the least-squares solution of the ratios with a prior of 1, which keeps the
/// overall colour. Leaves cameras that agree within about 1 % unchanged, bit for bit. Needs
/// `quality` and `facing` of the cameras. Deterministic.
void compensate_gains(const GainCompensationOptions& options,
                      GainCompensationScratch& scratch,
                      PersonModel& model);

}  // namespace atrium::renderer
