#pragma once

#include <string_view>

namespace atrium::config {

/// Whether `written` may be `meant`, misspelt: at most two letters more, less or other than it (two
/// that changed places are two), and at least half of them the same.
bool may_be_meant(std::string_view written, std::string_view meant);

}  // namespace atrium::config
