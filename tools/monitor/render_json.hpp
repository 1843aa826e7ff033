#pragma once

#include "tools/monitor/report.hpp"

#include <string>

namespace atrium::monitor {

/// Renders the report as one JSON object on one line, without line end. docs/monitor.md lists the
/// keys.
std::string render_json(const Report& report);

}  // namespace atrium::monitor
