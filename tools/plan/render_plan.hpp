#pragma once

#include "tools/plan/simulation.hpp"
#include "tools/plan/site_plan.hpp"

#include <optional>
#include <string>

namespace atrium::plan {

/// The plan for people: hosts with cameras, load and links, then what does not fit, then the
/// assumptions.
std::string plan_text(const SitePlan& plan, const std::optional<SimulationResult>& simulated);

/// The same as JSON.
std::string plan_json(const SitePlan& plan, const std::optional<SimulationResult>& simulated);

}  // namespace atrium::plan
