#pragma once

#include "core/base/expected.hpp"
#include "core/config/rig.hpp"
#include "tools/calibrate/report/compare_rigs.hpp"

#include <Eigen/Core>

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace atrium::calibrate {

/// A point that a camera saw, beside where the calibration has it.
struct PointError {
    Eigen::Vector2d px = Eigen::Vector2d::Zero();        // where it was seen, distorted
    Eigen::Vector2d error_px = Eigen::Vector2d::Zero();  // seen minus projected
    bool is_outlier = false;
};

struct ReportedCamera {
    geometry::CalibratedCamera camera;  // in the frame of the new rig
    double held_out_px = 0.0;           // RMS per coordinate, of points that no solution used
    double rms_px = 0.0;                // of the others
    double middle_mm = 0.0;             // rms_px in the middle of what was seen
    double coverage = 0.0;              // share of the picture in which it saw points
    double late_instants = 0.0;
    std::size_t num_used = 0, num_outliers = 0;
    std::vector<PointError> errors;
};

enum class Grade : std::uint8_t { kGood, kUsable, kWrong };

/// All that a person wants to know of a calibration, for one page.
struct CalibrationReport {
    std::string command;  // for example "calibrate wand"
    std::string source;   // what was calibrated from
    std::string date;     // UTC, "2026-11-26 20:45:12"
    Grade grade = Grade::kGood;
    std::vector<std::string> told;      // the verdict in a sentence, then figures
    std::vector<std::string> checks;    // what could be better, with the cure
    std::vector<std::string> problems;  // with the cure
    std::string outcome;                // what was written, or why nothing was
    std::vector<ReportedCamera> cameras;
    std::vector<Eigen::Vector3d> seen_site;  // [m] places of the wand or board

    std::string previous;  // file of the rig that was there before; empty: none
    std::optional<config::Rig> previous_rig;
    std::optional<RigComparison> comparison;
};

/// One HTML page that loads nothing: verdict, the rig from above and from the side, and per camera
/// coverage, errors and distortion. All text is escaped.
std::string report_page(const CalibrationReport& report);

/// The same figures as JSON (docs/calibrate_report.md). Errors of single points are left out.
std::string report_json(const CalibrationReport& report);

/// Writes `FILE` and, beside it, the same with the extension `.json`; both may replace old ones.
Expected<void> write_report(const CalibrationReport& report, const std::filesystem::path& file);

}  // namespace atrium::calibrate
