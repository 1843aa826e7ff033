#pragma once

#include "site_node/stream/link_estimator.hpp"

#include <chrono>

namespace atrium::stream {

/// The time `seconds` after the start of a test.
inline Time at(double seconds) {
    return Time{} +
           std::chrono::duration_cast<Time::duration>(std::chrono::duration<double>(seconds));
}

}  // namespace atrium::stream
