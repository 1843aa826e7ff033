#pragma once

#include "site_node/pipeline.hpp"

#include <cstdint>
#include <string>

namespace atrium::site_node {

/// What `SiteStatus` does not tell, since the start.
struct SiteCounts {
    std::uint64_t num_incomplete_used = 0;  // metaframes that went on without some cameras
    std::uint64_t num_phantoms = 0;         // as `LeftOut`, over all metaframes with a hull
    std::uint64_t num_fragments = 0;
    std::uint64_t num_contours_dropped = 0;
    std::uint64_t num_contours_repaired = 0;
    std::uint64_t num_regions_failed = 0;

    SiteCounts operator-(const SiteCounts& former) const;
    bool operator==(const SiteCounts&) const = default;
};

/// Adds to all but `num_incomplete_used`.
void add(const LeftOut& left_out, SiteCounts& counts);

/// `key=value ...` for the log; empty where nothing was counted.
std::string to_line(const SiteCounts& counts);

}  // namespace atrium::site_node
