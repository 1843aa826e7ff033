#pragma once

#include "core/keys/store.hpp"

#include <span>
#include <string>

namespace atrium::keys_tool {

/// The members of a world as a table, one line each.
std::string list_text(const std::string& world, std::span<const keys::Entry> entries);
/// The same as JSON (docs/keys.md).
std::string list_json(const std::string& world, std::span<const keys::Entry> entries);

/// "push+grab"; "-" for a kind of member that has none.
std::string shown_rights(const keys::Member& member);

}  // namespace atrium::keys_tool
