#pragma once

#include "core/base/expected.hpp"
#include "core/bus/messages.hpp"

/// Checks messages: writers before they send, readers after they receive. limits.hpp has the
/// bounds. Errors are kInvalidData and name the field and the allowed values.
namespace atrium::bus {

/// For each message of messages.hpp.
template <typename Message>
Expected<void> check(const Message& message);

}  // namespace atrium::bus
