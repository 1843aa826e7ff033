#pragma once

#include "core/base/descriptor.hpp"
#include "core/base/expected.hpp"
#include "site_node/segmentation_worker/protocol.hpp"

#include <chrono>
#include <filesystem>
#include <optional>

namespace atrium::segmentation_worker {

/// Longest path of a socket [bytes], of Linux.
inline constexpr std::size_t kMaxPathBytes = 107;

/// A connection to a worker (UNIX socket, SOCK_SEQPACKET). Only `wait` blocks.
class WorkerSocket {
public:
    /// Connects and passes the descriptor of the shared memory. Errors: kUnavailable.
    static Expected<WorkerSocket> connect(const std::filesystem::path& path, int shared_memory);

    /// Errors: kUnavailable if the worker is gone or takes no messages.
    Expected<void> send(const SiteMessage& message);

    /// Returns the next message, nullopt if none has come. Errors: kUnavailable if the worker is
    /// gone, else as `decode`.
    Expected<std::optional<WorkerMessage>> receive();

    /// Waits until `receive` has something to say, at most this long.
    void wait(std::chrono::nanoseconds limit) const;

private:
    explicit WorkerSocket(Descriptor socket) : socket_(std::move(socket)) {}

    Descriptor socket_;
};

}  // namespace atrium::segmentation_worker
