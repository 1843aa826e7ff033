#include "bench/usage.hpp"
#include "tests/integration/site_over_link.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <cmath>
#include <csignal>
#include <filesystem>
#include <functional>
#include <string>
#include <thread>
#include <vector>

// A site and a viewer over links with faults, one row of CSV each. stream_faults.sh makes the table
// of docs/measurements/streams.md from it:
//
//   stream_faults SECONDS_OF_EACH [ONLY]
//
// ONLY: only the case of this name.
namespace {

using namespace atrium::test;
using namespace std::chrono_literals;

struct Case {
    std::string name;
    Impairment link;
    int jpeg_quality = 86;
    /// Runs after 2 s of the measurement, and returns when the fault is over. Then the measurement
    /// runs as long again.
    std::function<void(ImpairedNetwork&, SiteOverLink&)> fault;
    std::chrono::seconds settle = 2s;  // before the measurement: time for the stream to adapt
};

void cut_for_three_seconds(ImpairedNetwork& network, SiteOverLink&) {
    network.cut(1);
    std::this_thread::sleep_for(3s);
    network.restore(1);
}

void stop_viewer_for_five_seconds(ImpairedNetwork&, SiteOverLink& run) {
    run.viewer().signal(SIGSTOP);
    std::this_thread::sleep_for(5s);
    run.viewer().signal(SIGCONT);
}

std::vector<Case> all_cases() {
    constexpr int kFine = 100;  // a stream that wants more than 20 Mbit/s
    std::vector<Case> cases{
        {"no fault, 2 ms", {.delay = 2ms}, 86, {}},
        {"1 % lost, 2 ms", {.delay = 2ms, .loss = 0.01}, 86, {}},
        {"5 % lost, 2 ms", {.delay = 2ms, .loss = 0.05}, 86, {}},
        {"50 +- 10 ms", {.delay = 50ms, .jitter = 10ms}, 86, {}},
        {"1 % lost, 50 +- 10 ms", {.delay = 50ms, .jitter = 10ms, .loss = 0.01}, 86, {}},
        {"5 % lost, 50 +- 10 ms", {.delay = 50ms, .jitter = 10ms, .loss = 0.05}, 86, {}},
        {"quality 100, no limit, 20 ms", {.delay = 20ms}, kFine, {}},
        {"quality 100, 20 Mbit/s, 20 ms", {.delay = 20ms, .rate_bit_per_s = 20e6}, kFine, {}, 8s},
        {"quality 100, 5 Mbit/s, 20 ms", {.delay = 20ms, .rate_bit_per_s = 5e6}, kFine, {}, 8s},
        {"cut for 3 s, 20 ms", {.delay = 20ms}, 86, cut_for_three_seconds},
        {"viewer stopped for 5 s, 20 ms", {.delay = 20ms}, 86, stop_viewer_for_five_seconds},
    };
    return cases;
}

int measure(const Case& fault_case,
            std::chrono::milliseconds duration,
            const std::filesystem::path& cache) {
    auto network = ImpairedNetwork::create(2, 21);
    if (!network) {
        fmt::print(stderr, "{}\n", network.error().message);
        return 3;
    }
    for (const int host : {0, 1}) (*network)->set(host, Way::kUp, fault_case.link);
    auto run = SiteOverLink::start(
        network->get(),
        {.jpeg_quality = fault_case.jpeg_quality, .cache = cache, .bus_options = {}});
    if (!run) {
        fmt::print(stderr, "{}: {}\n", fault_case.name, run.error().message);
        return 1;
    }
    std::this_thread::sleep_for(fault_case.settle);
    const Moment from = (*run)->moment();
    std::int64_t fault_over_ns = 0;
    if (fault_case.fault) {
        std::this_thread::sleep_for(2s);
        fault_case.fault(**network, **run);
        fault_over_ns = (*run)->moment().now_ns;
    }
    std::this_thread::sleep_for(duration);
    const Moment to = (*run)->moment();
    std::this_thread::sleep_for(1s);  // for repairs on their way
    const auto report = (*run)->finish(from, to);
    if (!report) {
        fmt::print(stderr, "{}: {}\n", fault_case.name, report.error().message);
        return 1;
    }
    fmt::print("\"{}\",{},{},{:.2f},{:.0f},{:.0f},{:.0f},{:.0f},{:.0f},{:.1f},{:.1f},{}\n",
               fault_case.name,
               report->num_published,
               report->num_complete,
               100.0 * report->share(),
               report->age_ms(0.5),
               report->age_ms(0.99),
               report->age_ms(1.0),
               1e-3 * report->bytes_per_s,
               fault_case.fault ? report->recovery_ms(fault_over_ns) : std::nan(""),
               1e-6 * static_cast<double>(report->resident_before),
               1e-6 * static_cast<double>(report->resident_after),
               report->num_out_of_order);
    std::fflush(stdout);
    return 0;
}

}  // namespace

int main(int argc, char** argv) {
    const std::vector<std::string> words =
        atrium::bench::words_or_usage(argc,
                                      argv,
                                      {1, 2},
                                      "usage: stream_faults SECONDS_OF_EACH [ONLY]\n"
                                      "A row of CSV per case of docs/measurements/streams.md, "
                                      "Faults; ONLY: only the case of this name.\n");
    const auto duration = std::chrono::milliseconds(std::lround(1000.0 * std::stod(words[0])));
    const std::string only = words.size() > 1 ? words[1] : "";
    const auto cache =
        std::filesystem::temp_directory_path() / fmt::format("stream_faults-{}", getpid());
    fmt::print(
        "case,published,complete,share,p50_ms,p99_ms,max_ms,kb_per_s,recovery_ms,before_mb,"
        "after_mb,out_of_order\n");
    int result = 0;
    for (const Case& fault_case : all_cases()) {
        if ((only.empty() || fault_case.name == only) && result == 0)
            result = measure(fault_case, duration, cache);
    }
    std::filesystem::remove_all(cache);
    return result;
}
