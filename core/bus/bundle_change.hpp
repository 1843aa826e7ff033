#pragma once

#include "core/keys/bundle.hpp"

#include <string>

namespace atrium::bus {

/// Says what is wrong with a bundle that was copied over the file of a running program, as a line
/// for the log, with advice: it is of another member, world or key store, or has another key than
/// `own`, which the program goes on with. Empty if nothing is wrong. Private to core/bus.
std::string complaint_about(const keys::Bundle& now,
                            const keys::Bundle& own,
                            const std::string& file);

}  // namespace atrium::bus
