#pragma once

#include "core/base/expected.hpp"
#include "core/bus/messages.hpp"

#include <string_view>

/// Checks messages: writers before they send, readers after they receive. limits.hpp has the
/// bounds. Errors are kInvalidData and name the field and the allowed values.
namespace atrium::bus {

/// True for 1..63 characters of [A-Za-z0-9_.-].
bool is_valid_name(std::string_view name);

/// True for a relative path of 1..127 characters of [A-Za-z0-9_.-/] without a component that is
/// empty or begins with a dot. The path cannot leave the folder that it is appended to.
bool is_valid_model_file(std::string_view file);

/// For each message of messages.hpp.
template <typename Message>
Expected<void> check(const Message& message);

}  // namespace atrium::bus
