#include "site_node/coherence/fault_text.hpp"

#include "core/geometry/motion_text.hpp"

#include <fmt/format.h>

#include <cmath>

namespace atrium::coherence {

std::string motion_text(const NamedFault& fault) {
    return geometry::motion_text(fault.turned_deg, fault.moved_mm, fault.is_either);
}

std::string late_cure(const NamedFault& fault) {
    const double whole = std::round(-fault.late_instants);
    return fmt::format(
        "check its trigger, or shift its pictures by {}",
        whole == 0.0 ? "less than an instant, by its clock" : fmt::format("{:.0f}", whole));
}

std::string late_text(const NamedFault& fault, const std::string& camera, double rate_hz) {
    const double late = fault.late_instants;
    return fmt::format(
        "camera '{}' is {} by {:.1f} instants{}: its pictures fit the motion of the person at "
        "another time; {}",
        camera,
        late > 0.0 ? "late" : "early",
        std::abs(late),
        rate_hz > 0.0 ? fmt::format(" ({:.0f} ms)", 1000.0 * std::abs(late) / rate_hz) : "",
        late_cure(fault));
}

std::string lenses_text(double factor) {
    return fmt::format("lenses {:.2f} times as long as the rig says", factor);
}

std::string other_lenses_text(double before_px, double after_px, const std::string& with) {
    return fmt::format(
        "these are other lenses than those of the calibration: silhouettes differ by {:.2f} px, by "
        "{:.2f} px with {}: zoom, focus, a crop or stabilisation: film and calibrate alike",
        before_px,
        after_px,
        with);
}

}  // namespace atrium::coherence
