#pragma once

#include "monitor/report.hpp"

#include <string>

namespace atrium::monitor {

/// The report as one JSON object on one line, without the line's end. docs/monitor.md has the keys.
std::string render_json(const Report& report);

}  // namespace atrium::monitor
