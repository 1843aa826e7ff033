#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Core>

#include <array>
#include <cstddef>
#include <vector>

namespace atrium::renderer {

struct PersonModel;

struct ColourEveningOptions {
    std::size_t max_points = 600;  // of the surface, where cameras are compared; 0: no evening
    std::size_t min_shared = 16;   // cameras that share fewer points are not compared
    double prior = 0.2;            // expected deviation of a camera's factors from 1, logarithm
    double doubt = 0.02;           // of what two cameras tell of each other, however many points
    double dead_zone = 0.01;       // of the logarithm: nobody sees that, and noise stays below it
};

struct ColourEveningScratch {
    std::vector<Eigen::Array3f> log_colours;  // [camera][point]; not finite where it does not see
    std::vector<float> differences;
    std::vector<float> deviations;
    std::vector<std::array<double, 3>> weights;  // [camera][camera]
    std::vector<Eigen::Array3d> ratios;          // [camera][camera], logarithms
    Eigen::MatrixXd normal_matrix;
    Eigen::VectorXd solution;
    Eigen::LLT<Eigen::MatrixXd> solver;
    /// Natural logarithm of the factors that were applied, per camera and channel.
    std::vector<Eigen::Array3d> log_gains;
};

/// Evens out what the cameras disagree about in their colours, by one factor per camera and
/// channel on `model.layers`: no seam is left where one camera's colours meet another's.
///
/// Points in the middle of faces that two cameras see well tell the ratio of the two, of which the
/// median is taken; the factors are the least squares of these against a prior of 1, so that the
/// person's colour as a whole stays. Cameras that agree to about 1 % are left alone, bit for bit.
/// Needs the cameras' `quality` and `facing`. Deterministic.
void even_colours(const ColourEveningOptions& options,
                  ColourEveningScratch& scratch,
                  PersonModel& model);

}  // namespace atrium::renderer
