#include "core/geometry/motion_text.hpp"

#include <fmt/format.h>

namespace atrium::geometry {

std::string motion_text(std::optional<double> turned_deg,
                        std::optional<double> moved_mm,
                        bool is_either) {
    const std::string turned =
        turned_deg ? fmt::format("turned by {:.2f} degrees", *turned_deg) : "";
    const std::string moved = moved_mm ? fmt::format("moved by {:.0f} mm", *moved_mm) : "";
    if (turned.empty() && moved.empty()) return "turned or moved a little";
    if (turned.empty() || moved.empty()) return turned + moved;
    return turned + (is_either ? " or " : " and ") + moved;
}

}  // namespace atrium::geometry
