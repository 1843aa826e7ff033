#pragma once

#include "tools/calibrate/adjust/bundle.hpp"
#include "tools/calibrate/wand/light_points.hpp"

#include <functional>
#include <string>
#include <vector>

namespace atrium::calibrate {

/// What is known of a camera before the calibration.
struct NominalCamera {
    std::string name;
    int width = 0, height = 0;
    double focal_px = 0.0;  // may be off by a third; 0: the picture's width
};

struct WandOptions {
    LensFreedom lens = LensFreedom::kAll;
    int num_threads = 1;
    /// Called with a short text when a step begins, or null.
    std::function<void(const std::string&)> report;
};

/// How well a camera is calibrated, and by what.
struct CameraFigures {
    std::size_t num_points = 0;               // bright points in its pictures
    std::size_t num_instants = 0;             // at which it showed the whole wand
    std::size_t num_used = 0;                 // sightings that the solution uses
    std::size_t num_outliers = 0;             // sightings that contradict it
    double rms_px = 0.0;                      // per coordinate, of those that it uses
    double held_out_px = 0.0;                 // the same, of sightings that a solution did not use
    double mean_x_px = 0.0, mean_y_px = 0.0;  // of the errors
    double coverage = 0.0;   // share of the picture, of 8 x 8 fields, in which it saw lights
    double middle_mm = 0.0;  // rms_px at the middle of the sweep
    /// [instants] The wand's motion explains its errors best if its pictures are this much late.
    double late_instants = 0.0;
};

struct WandSolution {
    Bundle bundle;                        // in the frame of the first placed camera
    std::vector<std::uint32_t> instants;  // numbers of the bundle's instants in the input
    std::vector<CameraFigures> cameras;
    std::size_t num_instants = 0;  // with a placed wand
    double rms_px = 0.0, held_out_px = 0.0;
    double wand_length_rms_m = 0.0;  // of the distance of its ends, each seen on its own
    /// [m] Of a line, per light: how much further along the wand it is seen than the wand says.
    std::vector<double> light_offsets_m;
    Eigen::Vector3d middle_world = Eigen::Vector3d::Zero();  // of the sweep
};

/// Calibrates cameras from the lights of a wand that was swept through the room: labels the points,
/// places cameras and wands without an initial guess, and adjusts all. Errors kConfiguration or
/// kInvalidData with the cause and the cure.
Expected<WandSolution> solve_wand(const Wand& wand,
                                  const std::vector<NominalCamera>& nominal,
                                  const LightPoints& points,
                                  const WandOptions& options);

}  // namespace atrium::calibrate
