#include "bench/scale/own_host.hpp"
#include "bench/usage.hpp"
#include "core/base/timestamp.hpp"
#include "tests/support/network/hosted_process.hpp"
#include "tests/support/network/impaired_network.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <sstream>
#include <string>
#include <thread>
#include <vector>

// Cost of many programs that are only present; one row of CSV. stream_scale.sh makes the tables of
// docs/measurements/streams.md, "Participants", from it:
//
//   stream_crowd idle PROGRAM NETWORK COUNT PER_SECOND SECONDS
//   stream_crowd announce NETWORK SECONDS       one program of `wan` or the like, and a peer that
//                                               is absent
//   stream_crowd head                           the column names of the first
//
// PROGRAM: crowd_member or subscriber, started COUNT times, PER_SECOND of them in a second.
namespace {

using namespace atrium;
using namespace std::chrono_literals;
using test::HostedProcess;

constexpr const char* kUsage =
    "usage: stream_crowd idle PROGRAM NETWORK COUNT PER_SECOND SECONDS\n"
    "       stream_crowd announce NETWORK SECONDS\n"
    "       stream_crowd head\n"
    "One row of docs/measurements/streams.md, Participants; head: the column names of the first.\n";
constexpr auto kPatience = 60s;
constexpr auto kSettle = 5s;

[[noreturn]] void fail(int code, const std::string& why) {
    fmt::print(stderr, "{}\n", why);
    std::exit(code);
}

using Processes = std::vector<std::unique_ptr<HostedProcess>>;

Processes start_all(const std::string& program,
                    const std::string& network,
                    const std::string& count,
                    double per_second) {
    const auto begin = std::chrono::steady_clock::now();
    Processes processes;
    for (std::size_t i = 0; i < std::stoul(count); ++i) {
        std::this_thread::sleep_until(begin + std::chrono::nanoseconds(std::llround(
                                                  1e9 * static_cast<double>(i) / per_second)));
        auto process = HostedProcess::start({ATRIUM_BIN_DIR "/" + program,
                                             "--network",
                                             network,
                                             "--name",
                                             fmt::format("member-{}", i),
                                             "--members",
                                             count});
        if (!process) fail(1, process.error().message);
        processes.push_back(std::move(*process));
    }
    return processes;
}

// When each program knew all others [ns], sorted.
std::vector<std::int64_t> times_of_knowledge(const Processes& processes) {
    std::vector<std::int64_t> times;
    for (const auto& process : processes) {
        if (!process->wait_for_output("knows ", kPatience))
            fail(1, "one does not know all: " + process->output());
        const std::string output = process->output();
        times.push_back(std::stoll(output.substr(output.find("knows ") + 6)));
    }
    std::sort(times.begin(), times.end());
    return times;
}

std::chrono::nanoseconds processor_time(const Processes& processes) {
    std::chrono::nanoseconds sum{};
    for (const auto& process : processes) sum += bench::processor_time(process->id());
    return sum;
}

void idle(const std::vector<std::string>& words) {
    if (const auto entered = bench::enter_own_host(); !entered) fail(3, entered.error().message);
    const std::int64_t begin_ns = Timestamp::now().ns;
    const Processes processes = start_all(words[1], words[2], words[3], std::stod(words[4]));
    const std::int64_t started_ns = Timestamp::now().ns;
    const auto known = times_of_knowledge(processes);
    const double start_s = 1e-9 * static_cast<double>(processor_time(processes).count());
    std::this_thread::sleep_for(kSettle);
    const auto lo_before = bench::loopback_counters();
    const auto before = processor_time(processes);
    const auto host_before = bench::host_processor_time();
    const std::int64_t from_ns = Timestamp::now().ns;
    std::this_thread::sleep_for(std::chrono::seconds(std::stoul(words[5])));
    const double seconds = 1e-9 * static_cast<double>(Timestamp::now().ns - from_ns);
    const auto spent = processor_time(processes) - before;
    const auto host = bench::host_processor_time() - host_before;
    const auto lo = bench::loopback_counters();
    double memory_mb = 0.0;
    for (const auto& process : processes)
        memory_mb += 1e-6 * static_cast<double>(bench::memory_bytes(process->id()));
    const auto count = static_cast<double>(processes.size());
    fmt::print("{},{},{:.1f},{:.3f},{:.1f},{:.1f},{:.1f},{:.2f},{:.2f},{:.1f},{:.0f},{:.0f}\n",
               words[1],
               processes.size(),
               seconds,
               1e-7 * static_cast<double>(spent.count()) / seconds / count,
               1e-7 * static_cast<double>(spent.count()) / seconds,
               1e-7 * static_cast<double>(host.count()) / seconds,
               start_s,
               1e-9 * static_cast<double>(started_ns - begin_ns),
               1e-9 * static_cast<double>(known.back() - started_ns),
               memory_mb / count,
               static_cast<double>(lo.datagrams - lo_before.datagrams) / seconds,
               1e-3 * static_cast<double>(lo.bytes - lo_before.bytes) / seconds);
}

// Traffic of one program to a host without programs.
void announce(const std::vector<std::string>& words) {
    auto network = test::ImpairedNetwork::create(2, 1);
    if (!network) fail(3, network.error().message);
    auto process = (*network)->start(0,
                                     {ATRIUM_BIN_DIR "/crowd_member",
                                      "--network",
                                      words[1],
                                      "--interface",
                                      test::kLinkName,
                                      "--peers",
                                      (*network)->address(1),
                                      "--members",
                                      "1"});
    if (!process) fail(1, process.error().message);
    if (!(*process)->wait_for_output("knows ", kPatience)) fail(1, (*process)->output());
    std::this_thread::sleep_for(kSettle);
    const auto before = (*network)->counters(0, test::Way::kUp);
    const auto spent_before = bench::processor_time((*process)->id());
    const std::int64_t from_ns = Timestamp::now().ns;
    std::this_thread::sleep_for(std::chrono::seconds(std::stoul(words[2])));
    const double seconds = 1e-9 * static_cast<double>(Timestamp::now().ns - from_ns);
    const auto after = (*network)->counters(0, test::Way::kUp);
    const auto spent = bench::processor_time((*process)->id()) - spent_before;
    fmt::print("{}: {:.1f} packets/s, {:.1f} kbit/s, {:.3f} % of a core\n",
               words[1],
               static_cast<double>(after.entered - before.entered) / seconds,
               8e-3 * static_cast<double>(after.entered_bytes - before.entered_bytes) / seconds,
               1e-7 * static_cast<double>(spent.count()) / seconds);
}

}  // namespace

int main(int argc, char** argv) {
    const std::vector<std::string> words = bench::words_or_usage(argc, argv, {1, 3, 6}, kUsage);
    if (words.size() == 1 && words[0] == "head") {
        fmt::print(
            "program,count,seconds,percent_each,percent_all,host_percent,start_cpu_s,started_s,"
            "then_all_know_s,mb_each,datagrams_per_s,kb_per_s\n");
    } else if (words.size() == 6 && words[0] == "idle") {
        idle(words);
    } else if (words.size() == 3 && words[0] == "announce") {
        announce(words);
    } else {
        fmt::print(stderr, "{}", kUsage);
        return 2;
    }
    return 0;
}
