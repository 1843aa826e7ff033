#include "tools/doctor/checks/checks.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cassert>

namespace atrium::doctor {
namespace {

constexpr double kMaxError_ms = 50.0;        // of latencies between hosts
constexpr double kMaxErrorOfHosts_ms = 2.0;  // of triggers, which fire by the clock
// A healthy daemon may ask its time server after 2048 s again, and then the kernel says this much.
constexpr double kKernelGrowth_ms = 0.5 * 2048;

constexpr std::array kWorstFirst{"systemd-timesyn", "ntpd", "phc2sys", "chronyd"};

struct ClockError {
    double ms = 0.0;
    double limit_ms = 0.0;  // above which it is a finding
    double wanted_ms = 0.0;
};

// The hosts of a site only have to agree: with a time server in the LAN, or as that server itself,
// the error to the true time does not count.
ClockError error_of(const Facts& facts) {
    const ClockFacts& clock = facts.clock;
    const bool must_agree = facts.wishes.hosts.is_listed && !clock.serves_others;
    const double wanted = must_agree ? kMaxErrorOfHosts_ms : kMaxError_ms;
    if (!clock.chrony)
        return {clock.max_error_ms, must_agree ? wanted : wanted + kKernelGrowth_ms, wanted};
    const bool is_near = card_towards(facts.network, clock.chrony->source) != nullptr;
    return {
        must_agree && is_near ? clock.chrony->follows_ms : clock.chrony->bound_ms, wanted, wanted};
}

bool has_daemon(const ClockFacts& clock, const char* name) {
    return std::find(clock.daemons.begin(), clock.daemons.end(), name) != clock.daemons.end();
}

std::string service_of(const std::string& daemon) {
    if (daemon == "systemd-timesyn") return "systemd-timesyncd";
    if (daemon == "chronyd") return "chrony";
    return daemon == "ntpd" ? "ntpsec" : daemon;
}

}  // namespace

Findings check_clock(const Facts& facts) {
    Findings findings;
    const ClockFacts& clock = facts.clock;
    const bool is_alone = facts.wishes.network == "loopback";  // one host, one clock
    if (clock.daemons.size() > 1) {
        // the one that keeps the worst time
        const auto* const spare = std::ranges::find_if(
            kWorstFirst, [&](const char* name) { return has_daemon(clock, name); });
        assert(spare != kWorstFirst.end());
        findings.push_back(
            make_finding("two_time_daemons",
                         fmt::format("{} set the clock at the same time: it jumps; one must go.",
                                     fmt::join(clock.daemons, " and ")),
                         fmt::format("sudo systemctl disable --now {}", service_of(*spare))));
    }
    if (!clock.is_synchronised || is_alone) return findings;
    const ClockError error = error_of(facts);
    if (!*clock.is_synchronised && clock.daemons.empty()) {
        findings.push_back(make_finding(
            "no_time_daemon",
            "No program keeps the clock right (no chrony, NTP or PTP): latencies between hosts and "
            "the order of pictures mean nothing.",
            "sudo apt install chrony"));
    } else if (!*clock.is_synchronised) {
        const std::string service = service_of(clock.daemons.front());
        findings.push_back(make_finding(
            "clock_unsynchronised",
            fmt::format(
                "The clock is not synchronised, although {} runs: it reaches no time server.",
                service),
            has_daemon(clock, "chronyd") ? std::string("chronyc sources && sudo chronyc makestep")
                                         : fmt::format("sudo systemctl restart {}", service)));
    } else if (error.ms > error.limit_ms) {
        findings.push_back(make_finding(
            "clock_error_large",
            fmt::format(
                "The clock may be wrong by {:.3g} ms; {} wants {:g} ms: use a time server in the "
                "LAN (replace TIMEHOST).",
                error.ms,
                error.wanted_ms < kMaxError_ms
                    ? "a host of a site on several hosts, whose cameras trigger by it,"
                    : "a latency between hosts",
                error.wanted_ms),
            (has_daemon(clock, "chronyd") ? "" : std::string("sudo apt install chrony && ")) +
                write_line("server TIMEHOST iburst minpoll 2 maxpoll 4 prefer",
                           "/etc/chrony/sources.d/atrium.sources") +
                " && sudo chronyc reload sources"));
    }
    return findings;
}

}  // namespace atrium::doctor
