#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace atrium::config {

/// True if `written` may be a misspelling of `meant`: their Levenshtein distance is at most 2 and
/// at most half the length of `meant`. A transposition counts as 2.
bool may_be_misspelling(std::string_view written, std::string_view meant);

/// Returns those of `names` that `written` most probably stands for, best first, at most three.
/// Both may be keys with dots: `written` may lack the tables before the last dot, name another
/// table, lack a unit at its end ("rate" for "rate_hz") or have another ("limits_rad" for
/// "limits_deg"). '-' and '_' count as equal.
std::vector<std::string> names_meant_by(std::string_view written,
                                        const std::vector<std::string>& names);

/// Returns "did you mean A or B?", or nothing if `names` is empty. `before` precedes each name.
std::string ask_which(const std::vector<std::string>& names, std::string_view before = "");

/// Returns "must be one of A, B (did you mean B?)" for a `written` that is none of the choices.
std::string must_be_one_of(const std::vector<std::string>& choices, std::string_view written);

/// For a path that does not exist: finds files and folders beside its first missing part whose
/// names may be meant, by spelling, case or a missing extension. Returns "did you mean DIR/rooms?",
/// or nothing.
std::string ask_which_path(const std::filesystem::path& missing);

}  // namespace atrium::config
