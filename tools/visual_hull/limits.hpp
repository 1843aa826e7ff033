#pragma once

#include "core/base/expected.hpp"
#include "site_node/views/named_view.hpp"

#include <span>
#include <string>

namespace atrium::hull_tool {

/// Checks the limits of the hull for these views, to give better errors than "invalid input" or
/// "too complex": their number, which bounds lower by two, focal lengths and points. Errors name
/// the view, the limit and the value: kInvalidData for too many points, else kConfiguration.
Expected<void> check_limits(std::span<const views::NamedView> views, bool has_bounds);

/// Returns the limit that only the computation finds exceeded, with the view if known, as the end
/// of an error message.
std::string explain_too_complex(std::span<const views::NamedView> views);

}  // namespace atrium::hull_tool
