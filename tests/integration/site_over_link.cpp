#include "tests/integration/site_over_link.hpp"

#include "core/base/timestamp.hpp"
#include "tests/support/comes_true.hpp"
#include "tests/support/source_dir.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <csignal>
#include <fstream>
#include <set>
#include <sstream>

namespace atrium::test {
namespace {

using namespace std::chrono_literals;

constexpr auto kPatience = 120s;  // the room may have to be rendered

tl::unexpected<Error> failed(const std::string& what, const HostedProcess& process) {
    const std::string output = process.output();
    return make_error(
        ErrorKind::kInternal,
        what + ": " + output.substr(output.size() - std::min<std::size_t>(output.size(), 4000)));
}

std::vector<ShownFrame> read_shown(const std::string& output) {
    std::vector<ShownFrame> shown;
    std::istringstream lines(output);
    for (std::string line; std::getline(lines, line);) {
        std::istringstream words(line);
        std::string what;
        ShownFrame frame;
        if (words >> what >> frame.id >> frame.capture_ns >> frame.complete_ns && what == "frame")
            shown.push_back(frame);
    }
    return shown;
}

// Ids and capture times of all frames that the site published.
std::vector<ShownFrame> read_published(const std::string& output) {
    static const std::string kMark = " published id=";
    std::vector<ShownFrame> published;
    std::istringstream lines(output);
    for (std::string line; std::getline(lines, line);) {
        const std::size_t at = line.find(kMark);
        if (at == std::string::npos) continue;
        std::istringstream words(line.substr(at + kMark.size()));
        ShownFrame frame;
        std::string capture;
        words >> frame.id >> capture;  // capture_ns=...
        frame.capture_ns = std::stoll(capture.substr(capture.find('=') + 1));
        published.push_back(frame);
    }
    return published;
}

}  // namespace

std::int64_t resident_bytes(pid_t id) {
    std::ifstream file(fmt::format("/proc/{}/statm", id));
    std::int64_t size = 0;
    std::int64_t resident = 0;
    file >> size >> resident;
    return resident * sysconf(_SC_PAGESIZE);
}

double SiteReport::share() const {
    return static_cast<double>(num_complete) / static_cast<double>(num_published);
}

double SiteReport::published_per_s(std::int64_t from_ns, std::int64_t to_ns) const {
    const auto num = std::count_if(published_ns.begin(), published_ns.end(), [&](std::int64_t ns) {
        return ns > from_ns && ns <= to_ns;
    });
    return static_cast<double>(num) / (1e-9 * static_cast<double>(to_ns - from_ns));
}

double SiteReport::age_ms(double share) const {
    if (ages_ms.empty()) return std::nan("");
    return ages_ms[static_cast<std::size_t>(
        std::lround(share * static_cast<double>(ages_ms.size() - 1)))];
}

double SiteReport::recovery_ms(std::int64_t since_ns) const {
    for (const ShownFrame& frame : shown) {
        if (frame.capture_ns > since_ns)
            return static_cast<double>(frame.complete_ns - since_ns) * 1e-6;
    }
    return std::nan("");
}

Expected<std::unique_ptr<HostedProcess>> SiteOverLink::start_on(
    int host, std::vector<std::string> command, const SiteSettings& settings) const {
    if (network_ == nullptr) {
        command.insert(command.end(), settings.bus_options.begin(), settings.bus_options.end());
        return HostedProcess::start(command);
    }
    const std::string peer = network_->address(1 - host);
    for (const std::string& word :
         {std::string("--network"), std::string("wan"), std::string("--peers"), peer})
        command.push_back(word);
    return network_->start(host, command);
}

Expected<std::unique_ptr<SiteOverLink>> SiteOverLink::start(ImpairedNetwork* network,
                                                            const SiteSettings& settings) {
    std::unique_ptr<SiteOverLink> run(new SiteOverLink(network));
    const std::string programs = ATRIUM_BIN_DIR;
    auto viewer = run->start_on(1, {programs + "/stream_viewer"}, settings);
    if (!viewer) return tl::unexpected(viewer.error());
    run->viewer_ = std::move(*viewer);
    auto site = run->start_on(0,
                              {programs + "/site_node",
                               "--config",
                               atrium::test::source_dir() + "/deploy/sites/alice.toml",
                               "--simulation.loop_s",
                               "1",
                               "--simulation.cache",
                               settings.cache.string(),
                               "--codec.jpeg_quality",
                               std::to_string(settings.jpeg_quality),
                               "--log-level",
                               "debug"},
                              settings);
    if (!site) return tl::unexpected(site.error());
    run->site_ = std::move(*site);
    if (!run->site_->wait_for_output("network kind=", kPatience))
        return failed("the site", *run->site_);
    if (!run->viewer_->wait_for_output("frame ", kPatience))
        return failed("no frame arrives", *run->viewer_);
    return run;
}

Moment SiteOverLink::moment() const {
    return {Timestamp::now().ns,
            network_ != nullptr ? network_->counters(0, Way::kUp).entered_bytes : 0,
            resident_bytes(site_->id())};
}

bool SiteOverLink::wait_for_frame_after(std::int64_t capture_ns) {
    return test_support::comes_true([&] {
        const std::vector<ShownFrame> shown = read_shown(viewer_->output());
        return std::any_of(shown.begin(), shown.end(), [&](const ShownFrame& frame) {
            return frame.capture_ns > capture_ns;
        });
    });
}

Expected<SiteReport> SiteOverLink::finish(const Moment& from, const Moment& to) {
    site_->signal(SIGTERM);
    if (site_->wait(kPatience) != 0) return failed("the site", *site_);
    viewer_->signal(SIGTERM);
    if (viewer_->wait(kPatience) != 0) return failed("the viewer", *viewer_);
    SiteReport report;
    report.output_of_site = site_->output();
    report.shown = read_shown(viewer_->output());
    std::set<std::uint64_t> complete;
    std::int64_t newest_ns = 0;
    for (const ShownFrame& frame : report.shown) {
        if (frame.capture_ns <= newest_ns) {
            ++report.num_out_of_order;
            report.out_of_order += fmt::format(" frame {} captured at {} complete at {} after {};",
                                               frame.id,
                                               frame.capture_ns,
                                               frame.complete_ns,
                                               newest_ns);
        }
        newest_ns = std::max(newest_ns, frame.capture_ns);
        complete.insert(frame.id);
        if (frame.complete_ns > from.now_ns && frame.complete_ns <= to.now_ns)
            report.ages_ms.push_back(frame.age_ms());
    }
    std::sort(report.ages_ms.begin(), report.ages_ms.end());
    for (const ShownFrame& frame : read_published(report.output_of_site)) {
        report.published_ns.push_back(frame.capture_ns);
        if (frame.capture_ns <= from.now_ns || frame.capture_ns > to.now_ns) continue;
        ++report.num_published;
        report.num_complete += complete.count(frame.id);
    }
    report.bytes_per_s = static_cast<double>(to.sent_bytes - from.sent_bytes) /
                         (1e-9 * static_cast<double>(to.now_ns - from.now_ns));
    report.resident_before = from.resident_bytes;
    report.resident_after = to.resident_bytes;
    return report;
}

}  // namespace atrium::test
