#pragma once

#include "tools/calibrate/report/report.hpp"

#include <string>

namespace atrium::calibrate {

/// Text as HTML and SVG show it: with &amp; for &, and so on.
std::string escaped(const std::string& text);

/// The rig in parallel projection as SVG: cameras, what was seen, a floor of metres; the previous
/// rig in grey. `elevation_deg`: 90 from above, 0 from the side.
std::string draw_rig(const CalibrationReport& report, double azimuth_deg, double elevation_deg);

/// A camera's picture as SVG: points seen, outliers, and the mean error of each field as an arrow.
std::string draw_picture(const ReportedCamera& camera);

/// How far the lens moves a point, over its distance from the principal point, as SVG. `before`:
/// the lens of the previous rig, or null.
std::string draw_distortion(const geometry::PinholeCamera& lens,
                            const geometry::PinholeCamera* before);

}  // namespace atrium::calibrate
