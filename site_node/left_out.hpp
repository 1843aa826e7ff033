#pragma once

#include "core/bus/messages.hpp"
#include "site_node/pipeline.hpp"

#include <string>

namespace atrium::site_node {

/// Adds what one metaframe lacks.
void add(const LeftOut& left_out, bus::LeftOutTotals& totals);

/// `key=value ...` for the log: what was left out of hulls between two statuses of one site; empty
/// where nothing was.
std::string left_out_line(const bus::SiteStatus& from, const bus::SiteStatus& to);

}  // namespace atrium::site_node
