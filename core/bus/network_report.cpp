#include "core/bus/network_settings.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <sys/socket.h>
#include <unistd.h>

namespace atrium::bus {

namespace {

// A metaframe of eight cameras at full size has about 1.5 MB, mesh and textures, and is written at
// once. The metaframes of two sites can coincide.
constexpr std::size_t kBytesAtOnce = 3U << 20U;
constexpr std::size_t kRemedyBytes = 16U << 20U;

/// Receive buffer [bytes] that the kernel grants a socket that asks for `wanted`; 0 if unknown.
std::size_t granted_receive_buffer(std::size_t wanted) {
    const int probe = ::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
    if (probe < 0) return 0;
    const int size = static_cast<int>(wanted);
    int granted = 0;
    socklen_t length = sizeof granted;
    ::setsockopt(probe, SOL_SOCKET, SO_RCVBUF, &size, sizeof size);
    const int status = ::getsockopt(probe, SOL_SOCKET, SO_RCVBUF, &granted, &length);
    ::close(probe);
    // the kernel doubles the requested size for its book-keeping and reports the double
    return status == 0 ? static_cast<std::size_t>(granted) / 2 : 0;
}

std::string discovery(const NetworkSettings& settings) {
    std::string text = settings.multicast ? "multicast" : "unicast";
    if (!settings.peers.empty()) text += fmt::format(" peers={}", fmt::join(settings.peers, ","));
    return text;
}

}  // namespace

NetworkReport report_network(const NetworkSettings& settings) {
    const std::size_t granted = granted_receive_buffer(settings.receive_buffer_bytes);
    NetworkReport report;
    report.line = fmt::format(
        "network kind={} interface={} address={} discovery={} "
        "receive_buffer_kB={} keys={}",
        settings.kind,
        settings.card.empty() ? "any" : settings.card,
        settings.address.empty() ? "any" : settings.address,
        discovery(settings),
        granted >> 10U,
        settings.is_secured ? "yes" : "no");
    if (granted < kBytesAtOnce) {
        report.warnings.push_back(
            fmt::format("the receive buffer, {} kB, holds less than two frames of {} kB: samples "
                        "will be lost and sent again; run sysctl -w net.core.rmem_max={} (atrium "
                        "doctor checks the rest)",
                        granted >> 10U,
                        kBytesAtOnce >> 11U,
                        kRemedyBytes));
    }
    if (!settings.unreachable_peers.empty()) {
        report.warnings.push_back(
            fmt::format("bus.peers: bus.network = loopback reaches only this one host and ignores "
                        "{}; use --network lan, wifi or wan",
                        fmt::join(settings.unreachable_peers, ", ")));
    }
    const bool stays_here = settings.card.empty() || settings.address.rfind("127.", 0) == 0;
    const bool is_builtin =
        settings.kind == "lan" || settings.kind == "wifi" || settings.kind == "wan";
    if (stays_here && (is_builtin || (settings.kind != "loopback" && settings.has_remote_peers))) {
        report.warnings.push_back(fmt::format(
            "bus.network = {}: no active network card reaches other hosts; bring one "
            "up and name it with --interface (atrium doctor), or use --network loopback",
            settings.kind));
    }
    if (!settings.is_secured && !stays_here) {
        report.warnings.emplace_back(
            "no keys: everybody in this network sees and hears all rooms of this world, and may "
            "take any name; close it with `atrium keys init WORLD`, one bundle for each program, "
            "and --security BUNDLE");
    }
    if (settings.kind == "wan" && !settings.has_remote_peers) {
        report.warnings.emplace_back(
            "bus.network = wan without bus.peers finds only programs of this host; name the other "
            "hosts with --peers A,B");
    }
    return report;
}

}  // namespace atrium::bus
