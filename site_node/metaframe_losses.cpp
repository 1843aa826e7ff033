#include "site_node/metaframe_losses.hpp"

#include "core/bus/limits.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace atrium::site_node {

void add(const MetaframeLosses& losses, bus::LeftOutTotals& totals) {
    totals.num_cameras += losses.cameras;
    totals.num_phantoms += losses.phantoms;
    totals.num_fragments += losses.fragments;
    // cones of a bad calibration may meet kilometres away; the status must stay within its limits
    totals.dropped_l = std::min(totals.dropped_l + losses.dropped_l, bus::kMaxStatistic);
    totals.num_contours_dropped += losses.contours_dropped;
    totals.num_contours_repaired += losses.contours_repaired;
    totals.num_regions_failed += losses.regions_failed;
}

std::string losses_line(const bus::SiteStatus& from, const bus::SiteStatus& to) {
    if (to.num_incomplete_used == from.num_incomplete_used && to.left_out == from.left_out)
        return {};
    const bus::LeftOutTotals& a = from.left_out;
    const bus::LeftOutTotals& b = to.left_out;
    return fmt::format(
        "incomplete_used={} cameras={} phantoms={} fragments={} dropped_l={:.3g} "
        "contours_dropped={} contours_repaired={} regions_failed={}",
        to.num_incomplete_used - from.num_incomplete_used,
        b.num_cameras - a.num_cameras,
        b.num_phantoms - a.num_phantoms,
        b.num_fragments - a.num_fragments,
        b.dropped_l - a.dropped_l,
        b.num_contours_dropped - a.num_contours_dropped,
        b.num_contours_repaired - a.num_contours_repaired,
        b.num_regions_failed - a.num_regions_failed);
}

}  // namespace atrium::site_node
