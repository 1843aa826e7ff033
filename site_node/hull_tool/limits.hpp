#pragma once

#include "core/base/expected.hpp"
#include "site_node/hull_tool/named_view.hpp"

#include <span>
#include <string>

namespace atrium::hull_tool {

/// Whether the hull takes these views, of which it would only say "invalid input" or "too complex":
/// their number, which bounds lower by two, their focal lengths, and their points. Errors name the
/// view, what is allowed and what was found: kInvalidData of too many points, else kConfiguration.
Expected<void> check_limits(std::span<const NamedView> views, bool has_bounds);

/// The limits that only the computation finds exceeded, with the view where one can be named: the
/// end of an error's text.
std::string explain_too_complex(std::span<const NamedView> views);

}  // namespace atrium::hull_tool
