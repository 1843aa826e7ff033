#include "core/bus/bus.hpp"
#include "core/bus/bus_options.hpp"
#include "tests/integration/security/stream_gaps.hpp"

#include <CLI/CLI.hpp>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <map>
#include <string>
#include <vector>

/// Listens to the meshes of a world until it is ended, and says what arrived of each site: a line
/// "first SITE MS" at the first mesh, "gap SITE MS" after each silence of more than half a second,
/// and at the end "site SITE received N missing M lost K longest_gap_ms G median_ms L". What the
/// site dropped itself is not lost. Needs the site's clock.
namespace {

volatile std::sig_atomic_t stop = 0;

struct Stream {
    std::uint64_t num_received = 0;
    atrium::test::StreamGaps gaps;
    std::chrono::steady_clock::time_point last;
    double longest_gap_ms = 0.0;
    std::vector<double> latencies_ms;  // needs one clock
};

double ms(std::chrono::nanoseconds time) { return static_cast<double>(time.count()) / 1e6; }

}  // namespace

int main(int argc, char** argv) {
    using namespace atrium;
    bus::BusOptions options;
    double ignore_s = 0.0;
    CLI::App cli;
    cli.add_option("--join", options.join);
    cli.add_option("--security", options.security);
    cli.add_option("--bus.network", options.network);
    cli.add_option("--bus.domain", options.domain);
    cli.add_option("--ignore", ignore_s, "first part of each stream that is not counted [s]");
    CLI11_PARSE(cli, argc, argv);
    std::signal(SIGTERM, [](int) { stop = 1; });
    const auto participant = bus::Participant::create(options);
    if (!participant) {
        std::fprintf(stderr, "%s\n", participant.error().message.c_str());
        return 1;
    }
    auto meshes = bus::Reader<bus::SiteMesh>::create(*participant);
    auto statuses = bus::Reader<bus::SiteStatus>::create(*participant);
    auto waiter = bus::Waiter::create(*participant);
    if (!meshes || !statuses || !waiter) return 1;
    waiter->add(*meshes);
    const auto begin = std::chrono::steady_clock::now();
    std::map<std::string, Stream> streams;
    std::map<std::string, std::chrono::steady_clock::time_point> firsts;
    const auto take_statuses = [&] {
        statuses->take([&](bus::SiteStatus&& status) { streams[status.site].gaps.take(status); });
    };
    while (stop == 0) {
        waiter->wait(std::chrono::milliseconds(200));
        const auto now = std::chrono::steady_clock::now();
        meshes->take([&](bus::SiteMesh&& mesh) {
            const auto [first, is_new] = firsts.try_emplace(mesh.site, now);
            if (is_new) {
                std::printf("first %s %.0f\n", mesh.site.c_str(), ms(now - begin));
                std::fflush(stdout);
            }
            if (std::chrono::duration<double>(now - first->second).count() < ignore_s) return;
            Stream& stream = streams[mesh.site];
            if (stream.num_received++ > 0) {
                const double gap = ms(now - stream.last);
                stream.longest_gap_ms = std::max(stream.longest_gap_ms, gap);
                if (gap > 500.0) {
                    std::printf("gap %s %.0f\n", mesh.site.c_str(), gap);
                    std::fflush(stdout);
                }
            }
            stream.last = now;
            stream.gaps.take(mesh);
            stream.latencies_ms.push_back(ms(Timestamp::now() - mesh.capture_time));
        });
        take_statuses();
        for (const std::string& line : participant->take_mismatches())
            std::fprintf(stderr, "%s\n", line.c_str());
        for (const std::string& line : participant->take_dds_log())
            std::fprintf(stderr, "%s\n", line.c_str());
    }
    // what the sites dropped until now, they say within a second
    const Timestamp end = Timestamp::now();
    const auto are_covered = [&] {
        return std::ranges::all_of(streams,
                                   [&](const auto& item) { return item.second.gaps.covers(end); });
    };
    const auto give_up = std::chrono::steady_clock::now() + std::chrono::seconds(5);
    while (!are_covered() && std::chrono::steady_clock::now() < give_up) {
        waiter->wait(std::chrono::milliseconds(200));
        meshes->take([](bus::SiteMesh&&) {});
        take_statuses();
    }
    for (auto& [site, stream] : streams) {
        auto& all = stream.latencies_ms;
        std::ranges::sort(all);
        const std::uint64_t missing = stream.gaps.num_missing();
        std::printf(
            "site %s received %llu missing %llu lost %llu longest_gap_ms %.0f median_ms %.1f\n",
            site.c_str(),
            static_cast<unsigned long long>(stream.num_received),
            static_cast<unsigned long long>(missing),
            static_cast<unsigned long long>(stream.gaps.num_lost(missing)),
            stream.longest_gap_ms,
            all.empty() ? 0.0 : all[all.size() / 2]);
    }
    return 0;
}
