#pragma once

#include "core/bus/messages.hpp"
#include "site_node/pipeline.hpp"

#include <string>

namespace atrium::site_node {

/// Adds the counts of one metaframe to the totals.
void add(const MetaframeLosses& losses, bus::LeftOutTotals& totals);

/// Formats the losses of one site between two statuses as `key=value ...` for the log. Empty
/// without losses.
std::string losses_line(const bus::SiteStatus& from, const bus::SiteStatus& to);

}  // namespace atrium::site_node
