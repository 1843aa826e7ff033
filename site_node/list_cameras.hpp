#pragma once

#include "core/base/expected.hpp"

namespace atrium::site_node {

/// Prints a table of all cameras that answer to standard output. Error kNotFound, with hints, if
/// none answers.
Expected<void> list_cameras();

}  // namespace atrium::site_node
