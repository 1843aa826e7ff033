#include "core/bus/bus.hpp"
#include "core/bus/bus_options.hpp"

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
/// and at the end "site SITE received N missing M longest_gap_ms G median_ms L".
namespace {

volatile std::sig_atomic_t stop = 0;

struct Stream {
    std::uint64_t num_received = 0;
    std::uint64_t num_missing = 0;
    std::uint64_t last_frame = 0;
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
    auto waiter = bus::Waiter::create(*participant);
    if (!meshes || !waiter) return 1;
    waiter->add(*meshes);
    const auto begin = std::chrono::steady_clock::now();
    std::map<std::string, Stream> streams;
    std::map<std::string, std::chrono::steady_clock::time_point> firsts;
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
                if (mesh.frame_id > stream.last_frame + 1)
                    stream.num_missing += mesh.frame_id - stream.last_frame - 1;
                if (gap > 500.0) {
                    std::printf("gap %s %.0f\n", mesh.site.c_str(), gap);
                    std::fflush(stdout);
                }
            }
            stream.last = now;
            stream.last_frame = mesh.frame_id;
            stream.latencies_ms.push_back(ms(Timestamp::now() - mesh.capture_time));
        });
        for (const std::string& line : participant->take_mismatches())
            std::fprintf(stderr, "%s\n", line.c_str());
        for (const std::string& line : participant->take_dds_log())
            std::fprintf(stderr, "%s\n", line.c_str());
    }
    for (auto& [site, stream] : streams) {
        auto& all = stream.latencies_ms;
        std::ranges::sort(all);
        std::printf("site %s received %llu missing %llu longest_gap_ms %.0f median_ms %.1f\n",
                    site.c_str(),
                    static_cast<unsigned long long>(stream.num_received),
                    static_cast<unsigned long long>(stream.num_missing),
                    stream.longest_gap_ms,
                    all.empty() ? 0.0 : all[all.size() / 2]);
    }
    return 0;
}
