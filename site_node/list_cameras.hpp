#pragma once

#include "core/base/expected.hpp"

namespace atrium::site_node {

/// Prints a table of the cameras that answer to standard output. Error kNotFound, saying what to
/// look at, where none does.
Expected<void> list_cameras();

}  // namespace atrium::site_node
