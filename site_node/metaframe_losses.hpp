#pragma once

#include "core/bus/messages.hpp"
#include "site_node/pipeline.hpp"

#include <string>

namespace atrium::site_node {

/// Adds the counts of one metaframe to the totals.
void add(const MetaframeLosses& losses, bus::LeftOutTotals& totals);

/// Formats what the hulls of one site lost between two statuses as `key=value ...` for the log.
/// Empty if they lost nothing.
std::string losses_line(const bus::SiteStatus& from, const bus::SiteStatus& to);

}  // namespace atrium::site_node
