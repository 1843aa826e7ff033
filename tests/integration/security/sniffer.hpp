#pragma once

#include "core/base/expected.hpp"

#include <atomic>
#include <cstdint>
#include <memory>
#include <mutex>
#include <thread>
#include <vector>

namespace atrium::test {

/// Records all UDP datagrams on loopback, as one who listens does. Their payloads.
class Sniffer {
public:
    /// kUnavailable without the right to.
    static Expected<std::unique_ptr<Sniffer>> start();
    ~Sniffer();

    /// What came since the start, or since the last call.
    std::vector<std::vector<std::uint8_t>> take();

private:
    explicit Sniffer(int socket);
    void collect();

    int socket_;
    std::mutex mutex_;
    std::vector<std::vector<std::uint8_t>> datagrams_;
    std::atomic<bool> ends_{false};
    std::thread thread_;
};

}  // namespace atrium::test
