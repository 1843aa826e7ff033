#pragma once

#include "core/geometry/pinhole_camera.hpp"
#include "tools/calibrate/adjust/wand.hpp"
#include "tools/calibrate/wand/light_points.hpp"
#include "tools/calibrate/wand/solve_wand.hpp"

#include <cstdint>
#include <functional>
#include <vector>

/// Cameras around a space through which a wand is swept.
namespace atrium::calibrate_test {

struct SweepOptions {
    std::uint32_t seed = 1;
    std::size_t num_cameras = 8;
    std::uint32_t num_instants = 300;
    double noise_px = 0.2;
    double outliers = 0.03;       // share of the points, moved by up to 60 px
    double reflections = 0.1;     // per picture: chance of a point that is no light
    double missed = 0.02;         // share of the lights that a camera does not detect
    double nominal_error = 0.15;  // of the focal lengths that are told
    bool has_labels = false;
    double rate_hz = 30.0;
    std::vector<double> late_instants{};  // per camera; empty: all in time
    std::uint32_t sweep_seed = 0;         // of all but the cameras; 0: of both
    /// What happened to the cameras before the sweep, or null.
    std::function<void(std::vector<geometry::CalibratedCamera>&)> change{};
};

struct SweptRoom {
    std::vector<geometry::CalibratedCamera> cameras;  // the truth
    std::vector<calibrate::NominalCamera> nominal;
    calibrate::LightPoints points;
};

SweptRoom sweep(const calibrate::Wand& wand, const SweepOptions& options);

/// RMS of the cameras' distances from the truth, after the rigid motion that fits best [m]. With
/// `may_scale` after the similarity that fits best.
double centres_rms_m(const SweptRoom& room,
                     const calibrate::WandSolution& solution,
                     bool may_scale = false);

}  // namespace atrium::calibrate_test
