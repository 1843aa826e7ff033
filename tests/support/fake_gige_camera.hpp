#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>

namespace atrium::test_support {

/// A GigE Vision camera that does not exist, served by Aravis over the real protocol, on threads of
/// its own, at a loopback address. The sensor has 2048 x 2048 pixels at most.
class FakeGigeCamera {
public:
    struct Options {
        std::string address;
        std::string serial;
        std::uint64_t first_number = 1;   // of its pictures
        double lost_packets = 0.0;        // part of all
        double trigger_check_hz = 200.0;  // how often it looks whether it was triggered
        /// The camera's time of picture `number` [ns]; none: as the host's clock says.
        std::function<std::uint64_t(std::uint64_t number, std::uint64_t host_ns)> clock;
    };

    explicit FakeGigeCamera(const Options& options);
    ~FakeGigeCamera();

    bool is_running() const;
    std::uint64_t num_sent() const;

    /// What byte `i` of picture `number` is; the number itself is in the first eight.
    static std::uint8_t expected_byte(std::uint64_t number, std::size_t i);
    static std::uint64_t number_in(const std::uint8_t* picture);

    /// A register as the site has set it.
    std::uint32_t register_value(std::uint32_t address) const;

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace atrium::test_support
