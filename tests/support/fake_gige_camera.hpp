#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>

namespace atrium::test_support {

/// A simulated GigE Vision camera at a loopback address. Aravis serves it over the real protocol,
/// on its own threads. The sensor has 2048 x 2048 pixels at most.
class FakeGigeCamera {
public:
    struct Options {
        std::string address;
        std::string serial;
        std::uint64_t first_number = 1;   // of its pictures
        double lost_packets = 0.0;        // fraction of all packets
        double trigger_check_hz = 200.0;  // rate at which it checks for triggers
        /// The camera's time of picture `number` [ns]. If empty, the host's clock.
        std::function<std::uint64_t(std::uint64_t number, std::uint64_t host_ns)> clock;
    };

    explicit FakeGigeCamera(const Options& options);
    ~FakeGigeCamera();

    bool is_running() const;
    std::uint64_t num_sent() const;

    /// Byte `i` of picture `number`. The first eight bytes hold the number itself.
    static std::uint8_t expected_byte(std::uint64_t number, std::size_t i);
    static std::uint64_t number_in(const std::uint8_t* picture);

    /// Value of a register, as the site has set it.
    std::uint32_t register_value(std::uint32_t address) const;

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace atrium::test_support
