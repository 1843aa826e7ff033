#include "bench/scale/own_host.hpp"
#include "bench/usage.hpp"
#include "core/base/timestamp.hpp"
#include "tests/support/network/hosted_process.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <csignal>
#include <map>
#include <memory>
#include <set>
#include <sstream>
#include <string>
#include <thread>
#include <vector>

// Sites and subscribers on one host, each in its own process; one row of CSV. stream_scale.sh makes
// the table and the picture of docs/measurements/streams.md, "Scale", from it:
//
//   stream_scale NAME NETWORK STREAM SITES SUBSCRIBERS DECODE SECONDS [KEYS]
//
// NETWORK: as for --network. STREAM: made by replayed_site --code. DECODE: true or false. KEYS:
// folder with site-0.bundle, viewer-0.bundle and so on, of a closed world. `stream_scale head`
// prints the column names.
namespace {

using namespace atrium;
using namespace std::chrono_literals;
using test::HostedProcess;

constexpr const char* kUsage =
    "usage: stream_scale NAME NETWORK STREAM SITES SUBSCRIBERS DECODE SECONDS [KEYS]\n"
    "       stream_scale head\n"
    "One row of docs/measurements/streams.md, Scale. NETWORK: as for --network; STREAM: made by\n"
    "replayed_site --code; DECODE: true or false; KEYS: folder with site-0.bundle, "
    "viewer-0.bundle\n"
    "...; head: the column names.\n";
constexpr auto kPatience = 60s;  // many programs on few cores
constexpr auto kSettle = 3s;
constexpr auto kLast = 1s;  // for frames on their way

[[noreturn]] void fail(int code, const std::string& why) {
    fmt::print(stderr, "{}\n", why);
    std::exit(code);
}

struct Moment {
    std::int64_t now_ns = 0;
    std::vector<std::chrono::nanoseconds> processor;  // of each process
    std::chrono::nanoseconds host{};
    bench::LoopbackCounters loopback;
};

/// Sites first, then subscribers.
class Run {
public:
    Run(const std::vector<std::string>& words)
        : network_(words[1]),
          stream_(words[2]),
          num_sites_(std::stoul(words[3])),
          num_subscribers_(std::stoul(words[4])),
          decode_(words[5]),
          keys_(words.size() > 7 ? words[7] : "") {
        for (std::size_t i = 0; i < num_sites_; ++i)
            start("replayed_site", fmt::format("site-{}", i), {"--stream", stream_});
        await("ready", 0, num_sites_);
        const std::vector<std::string> options{
            "--sites", std::to_string(num_sites_), "--decode", decode_};
        const auto begin = std::chrono::steady_clock::now();
        for (std::size_t i = 0; i < num_subscribers_; ++i)
            start("subscriber", fmt::format("viewer-{}", i), options);
        await(fmt::format("sees {}", num_sites_), num_sites_, processes_.size());
        seen_s_ = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    }

    /// From the start of the first subscriber until all see all sites.
    double seen_s() const { return seen_s_; }

    std::size_t num_sites() const { return num_sites_; }
    std::size_t num_subscribers() const { return num_subscribers_; }
    const std::vector<std::unique_ptr<HostedProcess>>& processes() const { return processes_; }

    Moment moment() const {
        Moment moment;
        moment.now_ns = Timestamp::now().ns;
        for (const auto& process : processes_)
            moment.processor.push_back(bench::processor_time(process->id()));
        moment.host = bench::host_processor_time();
        moment.loopback = bench::loopback_counters();
        return moment;
    }

    void finish() {
        for (auto process = processes_.rbegin(); process != processes_.rend(); ++process) {
            (*process)->signal(SIGTERM);
            if ((*process)->wait(kPatience) != 0) fail(1, (*process)->output());
        }
    }

private:
    void start(const std::string& program,
               const std::string& name,
               const std::vector<std::string>& options) {
        std::vector<std::string> command{
            ATRIUM_BIN_DIR "/" + program, "--network", network_, "--name", name};
        command.insert(command.end(), options.begin(), options.end());
        command.insert(
            command.end(),
            {"--security", keys_.empty() ? "none" : fmt::format("{}/{}.bundle", keys_, name)});
        auto process = HostedProcess::start(command);
        if (!process) fail(1, process.error().message);
        processes_.push_back(std::move(*process));
    }

    void await(const std::string& text, std::size_t from, std::size_t to) {
        for (std::size_t i = from; i < to; ++i) {
            if (!processes_[i]->wait_for_output(text, kPatience))
                fail(1, fmt::format("no '{}' from {}: {}", text, i, processes_[i]->output()));
        }
    }

    std::string network_;
    std::string stream_;
    std::size_t num_sites_;
    std::size_t num_subscribers_;
    std::string decode_;
    std::string keys_;  // empty: an open world
    double seen_s_ = 0.0;
    std::vector<std::unique_ptr<HostedProcess>> processes_;
};

/// The programs' results for the frames captured in an interval.
struct Outcome {
    std::size_t num_published = 0;  // of all sites
    std::size_t num_failed = 0;     // writes, of the whole run
    std::size_t num_complete = 0;   // of all subscribers
    std::size_t num_decoded = 0;    // likewise
    double worst_share = 1.0;       // of the subscriber with the fewest
    std::vector<double> ages_ms;    // from capture to complete, sorted

    double share(std::size_t num, std::size_t num_subscribers) const {
        return static_cast<double>(num) / static_cast<double>(num_published * num_subscribers);
    }
    double age_ms(double share) const {
        if (ages_ms.empty()) return std::nan("");
        return ages_ms[static_cast<std::size_t>(
            std::lround(share * static_cast<double>(ages_ms.size() - 1)))];
    }
};

void read_site(const std::string& output, const Moment& from, const Moment& to, Outcome& outcome) {
    std::istringstream lines(output);
    for (std::string line; std::getline(lines, line);) {
        std::istringstream words(line);
        std::string what;
        std::uint64_t number = 0;
        std::int64_t capture_ns = 0;
        words >> what >> number >> capture_ns;
        if (what == "failed") outcome.num_failed += number;
        if (what == "published" && capture_ns > from.now_ns && capture_ns <= to.now_ns)
            ++outcome.num_published;
    }
}

void read_subscriber(const std::string& output,
                     const Moment& from,
                     const Moment& to,
                     Outcome& outcome) {
    std::istringstream lines(output);
    std::size_t num_complete = 0;
    for (std::string line; std::getline(lines, line);) {
        std::istringstream words(line);
        std::string what;
        std::string site;
        std::uint64_t id = 0;
        std::int64_t capture_ns = 0;
        std::int64_t complete_ns = 0;
        words >> what >> site;
        if (what == "frame") words >> id;
        words >> capture_ns >> complete_ns;
        if (capture_ns <= from.now_ns || capture_ns > to.now_ns) continue;
        if (what == "person") ++outcome.num_decoded;
        if (what != "frame") continue;
        ++num_complete;
        outcome.ages_ms.push_back(1e-6 * static_cast<double>(complete_ns - capture_ns));
    }
    outcome.num_complete += num_complete;
    outcome.worst_share = std::min(outcome.worst_share, outcome.share(num_complete, 1));
}

Outcome read(const Run& run, const Moment& from, const Moment& to) {
    Outcome outcome;
    for (std::size_t i = 0; i < run.num_sites(); ++i)
        read_site(run.processes()[i]->output(), from, to, outcome);
    for (std::size_t i = run.num_sites(); i < run.processes().size(); ++i)
        read_subscriber(run.processes()[i]->output(), from, to, outcome);
    std::sort(outcome.ages_ms.begin(), outcome.ages_ms.end());
    return outcome;
}

// Mean processor use of some processes, of one core [%].
double percent(const Moment& from, const Moment& to, std::size_t first, std::size_t last) {
    std::chrono::nanoseconds sum{};
    for (std::size_t i = first; i < last; ++i) sum += to.processor[i] - from.processor[i];
    return 100.0 * static_cast<double>(sum.count()) /
           static_cast<double>((to.now_ns - from.now_ns)) / static_cast<double>(last - first);
}

double mean_memory_mb(const Run& run, std::size_t first, std::size_t last) {
    double sum = 0.0;
    for (std::size_t i = first; i < last; ++i)
        sum += 1e-6 * static_cast<double>(bench::memory_bytes(run.processes()[i]->id()));
    return sum / static_cast<double>(last - first);
}

}  // namespace

int main(int argc, char** argv) {
    const std::vector<std::string> words = bench::words_or_usage(argc, argv, {1, 7, 8}, kUsage);
    if (words.size() == 1 && words[0] == "head") {
        fmt::print(
            "case,sites,subscribers,decode,seconds,cores,site_percent,subscriber_percent,"
            "host_percent,published_per_s,share,worst_share,decoded_share,p50_ms,p99_ms,max_ms,"
            "datagrams_per_frame,kb_per_frame,site_mb,subscriber_mb,failed,seen_s\n");
        return 0;
    }
    if (words.size() == 1) {
        fmt::print(stderr, "{}", kUsage);
        return 2;
    }
    if (const auto entered = bench::enter_own_host(); !entered) fail(3, entered.error().message);
    Run run(words);
    std::this_thread::sleep_for(kSettle);
    const Moment from = run.moment();
    std::this_thread::sleep_for(std::chrono::seconds(std::stoul(words[6])));
    const Moment to = run.moment();
    const std::size_t sites = run.num_sites();
    const std::size_t all = run.processes().size();
    const double site_mb = mean_memory_mb(run, 0, sites);
    const double subscriber_mb = mean_memory_mb(run, sites, all);
    std::this_thread::sleep_for(kLast);
    run.finish();
    const Outcome outcome = read(run, from, to);
    const double seconds = 1e-9 * static_cast<double>(to.now_ns - from.now_ns);
    const auto published = static_cast<double>(outcome.num_published);
    fmt::print(
        "\"{}\",{},{},{},{:.1f},{},{:.2f},{:.2f},{:.1f},{:.2f},{:.5f},{:.5f},{:.5f},{:.2f},{:.2f},"
        "{:.1f},{:.2f},{:.2f},{:.1f},{:.1f},{},{:.2f}\n",
        words[0],
        sites,
        run.num_subscribers(),
        words[5],
        seconds,
        std::thread::hardware_concurrency(),
        percent(from, to, 0, sites),
        percent(from, to, sites, all),
        1e-7 * static_cast<double>((to.host - from.host).count()) / seconds,
        published / seconds / static_cast<double>(sites),
        outcome.share(outcome.num_complete, run.num_subscribers()),
        outcome.worst_share,
        outcome.share(outcome.num_decoded, run.num_subscribers()),
        outcome.age_ms(0.5),
        outcome.age_ms(0.99),
        outcome.age_ms(1.0),
        static_cast<double>(to.loopback.datagrams - from.loopback.datagrams) / published,
        1e-3 * static_cast<double>(to.loopback.bytes - from.loopback.bytes) / published,
        site_mb,
        subscriber_mb,
        outcome.num_failed,
        run.seen_s());
    return 0;
}
