#pragma once

#include "core/base/valid_name.hpp"
#include "core/bus/messages.hpp"

#include <string>
#include <string_view>

/// Checks names and texts that appear in messages and in world files.
namespace atrium::bus {

using atrium::is_valid_name;

/// True for a relative path of 1..127 characters of [A-Za-z0-9_.-/] without a component that is
/// empty or begins with a dot. The path cannot leave the folder that it is appended to.
bool is_valid_model_file(std::string_view file);

/// True for at most 255 printable ASCII characters; may be empty.
bool is_valid_line(std::string_view text);

/// The text as such a line: other characters are '?', and what is too long ends in "...".
std::string as_line(std::string text);

/// The name of a camera node or region node among the programs of its world: "SITE.HOST".
std::string host_program_name(const std::string& site, const std::string& host);

/// "site", "world server", "viewer", "program", "camera node", "region node"; also for a kind from
/// the network.
const char* kind_name(ProgramKind kind);

}  // namespace atrium::bus
