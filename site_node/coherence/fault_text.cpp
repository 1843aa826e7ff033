#include "site_node/coherence/fault_text.hpp"

#include <fmt/format.h>

#include <cmath>

namespace atrium::coherence {

// "turned by 0.20 degrees and moved by 10 mm"
std::string motion_text(const NamedFault& fault) {
    const std::string turned =
        fault.turned_deg ? fmt::format("turned by {:.2f} degrees", *fault.turned_deg) : "";
    const std::string moved =
        fault.moved_mm ? fmt::format("moved by {:.0f} mm", *fault.moved_mm) : "";
    if (turned.empty() && moved.empty()) return "turned or moved a little";
    if (turned.empty() || moved.empty()) return turned + moved;
    return turned + (fault.is_either ? " or " : " and ") + moved;
}

std::string late_text(const NamedFault& fault, const std::string& camera, double rate_hz) {
    const double late = fault.late_instants;
    const double whole = std::round(-late);
    return fmt::format(
        "camera '{}' is {} by {:.1f} instants ({:.0f} ms): its pictures fit the motion of the "
        "person at another time; check its trigger, or shift its pictures by {}",
        camera,
        late > 0.0 ? "late" : "early",
        std::abs(late),
        1000.0 * std::abs(late) / rate_hz,
        whole == 0.0 ? "less than an instant, by its clock" : fmt::format("{:.0f}", whole));
}

}  // namespace atrium::coherence
