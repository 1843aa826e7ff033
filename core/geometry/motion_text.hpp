#pragma once

#include <optional>
#include <string>

namespace atrium::geometry {

/// "turned by 0.20 degrees and moved by 10 mm": how a camera was moved. A part that is not certain
/// is left out. `is_either`: either one alone is possible.
std::string motion_text(std::optional<double> turned_deg,
                        std::optional<double> moved_mm,
                        bool is_either);

}  // namespace atrium::geometry
