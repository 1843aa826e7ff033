#pragma once

#include <string_view>

namespace atrium::config {

/// True if `written` may be a misspelling of `meant`: their Levenshtein distance is at most 2 and
/// at most half the length of `meant`. A transposition counts as 2.
bool may_be_misspelling(std::string_view written, std::string_view meant);

}  // namespace atrium::config
