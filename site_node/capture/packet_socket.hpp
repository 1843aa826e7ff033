#pragma once

#include "core/base/expected.hpp"

#include <chrono>
#include <cstdint>

namespace atrium::capture {

/// Waits until the packet socket of this process that is meant for UDP port `port` holds nothing
/// that came before its filter was set.
///
/// Aravis 0.8 opens a packet socket, which takes all packets of the interface at once, binds it and
/// only then sets its filter: a new stream may begin with pictures of other cameras. Call this
/// before the stream has buffers and before its camera sends: what is in the socket is then thrown
/// away by the receiving thread.
///
/// Returns at once where the receiving thread uses no packet socket after all, as far as can be
/// seen within `timeout`. Error kUnavailable: the receiving thread did not empty it in time.
Expected<void> wait_for_empty_packet_socket(std::uint16_t port, std::chrono::nanoseconds timeout);

}  // namespace atrium::capture
