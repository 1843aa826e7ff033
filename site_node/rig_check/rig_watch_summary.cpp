#include "core/base/median.hpp"
#include "site_node/rig_check/diagnosis.hpp"
#include "site_node/rig_check/rig_watch.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace atrium::rig_check {

std::string RigWatch::summary(bool is_rig_in_doubt) const {
    std::size_t rays = 0;
    std::size_t counted = 0;
    std::size_t explained = 0;
    double worst_share = 2.0;
    std::string worst;
    std::string blind;
    for (const auto& [name, camera] : cameras_) {
        rays += camera.rays;
        counted += camera.rays - camera.silent;
        explained += camera.explained;
        if (camera.looks_with_somebody == 0 && camera.looks_only_others > 0)
            blind += (blind.empty() ? "" : " ") + name;
        const double share = static_cast<double>(camera.explained) /
                             static_cast<double>(camera.rays - camera.silent);
        if (camera.rays == camera.silent || share >= worst_share) continue;
        worst_share = share;
        worst = name;
    }
    if (counted == 0) return {};
    const bool has_shifted = std::ranges::any_of(
        findings_, [](const auto& entry) { return entry.first.starts_with(kShifted); });
    const double share = static_cast<double>(explained) / static_cast<double>(counted);
    return fmt::format(
        "silhouettes looks={} explained={:.2f} fit={} worst={}:{:.2f} cut={:.2f}{}{}",
        num_looks_,
        share,
        share >= kFineShare && !is_rig_in_doubt && !has_shifted ? "good"
        : share >= kPoorShare                                   ? "fair"
                                                                : "poor",
        worst,
        worst_share,
        static_cast<double>(rays - counted) / static_cast<double>(rays),
        heights_m_.empty() ? "" : fmt::format(" height_m={:.2f}", median_of(heights_m_)),
        blind.empty() ? "" : fmt::format(" without_anybody=\"{}\"", blind));
}

}  // namespace atrium::rig_check
