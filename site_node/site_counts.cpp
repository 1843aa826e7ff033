#include "site_node/site_counts.hpp"

#include <fmt/format.h>

namespace atrium::site_node {

SiteCounts SiteCounts::operator-(const SiteCounts& former) const {
    return {num_incomplete_used - former.num_incomplete_used,
            num_phantoms - former.num_phantoms,
            num_fragments - former.num_fragments,
            num_contours_dropped - former.num_contours_dropped,
            num_contours_repaired - former.num_contours_repaired,
            num_regions_failed - former.num_regions_failed};
}

void add(const LeftOut& left_out, SiteCounts& counts) {
    counts.num_phantoms += left_out.phantoms;
    counts.num_fragments += left_out.fragments;
    counts.num_contours_dropped += left_out.contours_dropped;
    counts.num_contours_repaired += left_out.contours_repaired;
    counts.num_regions_failed += left_out.regions_failed;
}

std::string to_line(const SiteCounts& c) {
    if (c == SiteCounts{}) return {};
    return fmt::format(
        "incomplete_used={} phantoms={} fragments={} contours_dropped={} contours_repaired={} "
        "regions_failed={}",
        c.num_incomplete_used,
        c.num_phantoms,
        c.num_fragments,
        c.num_contours_dropped,
        c.num_contours_repaired,
        c.num_regions_failed);
}

}  // namespace atrium::site_node
