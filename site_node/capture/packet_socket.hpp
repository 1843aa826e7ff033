#pragma once

#include "core/base/expected.hpp"

#include <chrono>
#include <cstdint>

namespace atrium::capture {

/// Waits until the packet socket of this process for UDP port `port` holds no packet from before
/// its filter was set.
///
/// Aravis 0.8 opens a packet socket, which receives all packets of the interface, binds it and only
/// then sets its filter: a new stream may begin with pictures of other cameras. Call this before
/// the stream has buffers and before its camera sends; the receiving thread then discards these
/// packets.
///
/// Returns at once if no such socket appears within `timeout`, since the receiving thread may use a
/// normal one. Error kUnavailable if the receiving thread does not empty the socket in time.
Expected<void> wait_for_empty_packet_socket(std::uint16_t port, std::chrono::nanoseconds timeout);

}  // namespace atrium::capture
