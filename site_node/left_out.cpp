#include "site_node/left_out.hpp"

#include "core/bus/limits.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace atrium::site_node {

void add(const LeftOut& left_out, bus::LeftOutTotals& totals) {
    totals.num_cameras += left_out.cameras;
    totals.num_phantoms += left_out.phantoms;
    totals.num_fragments += left_out.fragments;
    // cones of a bad calibration may meet kilometres away; the status must stay within its limits
    totals.dropped_l = std::min(totals.dropped_l + left_out.dropped_l, bus::kMaxStatistic);
    totals.num_contours_dropped += left_out.contours_dropped;
    totals.num_contours_repaired += left_out.contours_repaired;
    totals.num_regions_failed += left_out.regions_failed;
}

std::string left_out_line(const bus::SiteStatus& from, const bus::SiteStatus& to) {
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
