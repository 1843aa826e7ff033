#include "tests/integration/stream_over_link.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <csignal>
#include <map>
#include <sstream>

namespace atrium::test {
namespace {

using namespace std::chrono_literals;

constexpr int kSamplesPerFrame = 9;
constexpr auto kPatience = 60s;

double at_share(std::vector<double> values, double share) {
    if (values.empty()) return std::nan("");
    const auto at = values.begin() + std::lround(share * static_cast<double>(values.size() - 1));
    std::nth_element(values.begin(), at, values.end());
    return *at;
}

LineCounters since(const LineCounters& before, LineCounters now) {
    now.entered -= before.entered;
    now.entered_bytes -= before.entered_bytes;
    now.duplicated -= before.duplicated;
    now.lost -= before.lost;
    now.dropped_by_queue -= before.dropped_by_queue;
    now.dropped_by_cut -= before.dropped_by_cut;
    now.left -= before.left;
    now.left_bytes -= before.left_bytes;
    return now;
}

void read_samples(const std::string& output, StreamReport& report) {
    std::istringstream lines(output);
    std::map<std::uint64_t, int> num_of_frame;
    std::array<std::uint64_t, kSamplesPerFrame> newest{};
    for (std::string line; std::getline(lines, line);) {
        std::istringstream words(line);
        std::string what;
        std::size_t key = 0;
        CompleteFrame frame;
        words >> what >> key >> frame.number >> frame.capture_ns >> frame.complete_ns;
        if (what != "sample" || key >= newest.size()) continue;
        ++report.num_samples;
        report.num_out_of_order += frame.number <= newest[key] ? 1 : 0;
        newest[key] = std::max(newest[key], frame.number);
        if (++num_of_frame[frame.number] == kSamplesPerFrame) report.complete.push_back(frame);
    }
}

void read_writes(const std::string& output, StreamReport& report) {
    std::istringstream words(output);
    for (std::string what; words >> what;) {
        double number = 0;
        if (what == "write" && words >> number) report.write_ms.push_back(number);
        if (what == "failed") words >> report.num_failed_writes;
        if (what == "retransmitted") words >> report.retransmitted_bytes;
    }
}

tl::unexpected<Error> failed(const std::string& what, const HostedProcess& process) {
    return make_error(ErrorKind::kInternal, fmt::format("{}: {}", what, process.output()));
}

}  // namespace

std::string network_xml(const ImpairedNetwork& network,
                        const std::string& internal,
                        int message_bytes,
                        int fragment_bytes) {
    return fmt::format(
        "<CycloneDDS><Domain Id=\"any\"><General>"
        "<Interfaces><NetworkInterface name=\"{}\" multicast=\"false\"/></Interfaces>"
        "<AllowMulticast>false</AllowMulticast>"
        "<MaxMessageSize>{}B</MaxMessageSize><FragmentSize>{}B</FragmentSize></General>"
        "<Discovery><ParticipantIndex>auto</ParticipantIndex>"
        "<MaxAutoParticipantIndex>3</MaxAutoParticipantIndex>"
        "<Peers><Peer Address=\"{}\"/><Peer Address=\"{}\"/></Peers>"
        "<SPDPInterval>300ms</SPDPInterval><LeaseDuration>1200ms</LeaseDuration></Discovery>"
        "<Internal><SocketReceiveBufferSize max=\"16MB\"/><SocketSendBufferSize max=\"2MB\"/>"
        "<MaxSampleSize>16MB</MaxSampleSize>{}</Internal></Domain></CycloneDDS>",
        kLinkName,
        message_bytes,
        fragment_bytes,
        network.address(0),
        network.address(1),
        internal);
}

double StreamReport::share_complete() const {
    return static_cast<double>(complete.size()) / static_cast<double>(write_ms.size());
}

double StreamReport::age_ms(double share) const {
    std::vector<double> ages_ms;
    for (const CompleteFrame& frame : complete)
        ages_ms.push_back(static_cast<double>(frame.complete_ns - frame.capture_ns) * 1e-6);
    return at_share(ages_ms, share);
}

double StreamReport::longest_gap_ms() const {
    std::int64_t gap_ns = 0;
    const CompleteFrame* newest = nullptr;
    for (const CompleteFrame& frame : complete) {
        if (newest != nullptr && frame.number < newest->number) continue;
        if (newest != nullptr) gap_ns = std::max(gap_ns, frame.complete_ns - newest->complete_ns);
        newest = &frame;
    }
    return static_cast<double>(gap_ns) * 1e-6;
}

double StreamReport::write_ms_at(double share) const { return at_share(write_ms, share); }

Expected<std::unique_ptr<StreamOverLink>> StreamOverLink::start(ImpairedNetwork& network,
                                                                const StreamSettings& settings) {
    std::unique_ptr<StreamOverLink> stream(new StreamOverLink(network, settings));
    const std::string program = ATRIUM_BIN_DIR "/stream_peer";
    auto reader = network.start(
        1, {program, "read", settings.network_file.string(), settings.profiles_file.string()});
    if (!reader) return tl::unexpected(reader.error());
    stream->reader_ = std::move(*reader);
    auto writer = network.start(0,
                                {program,
                                 "write",
                                 settings.network_file.string(),
                                 settings.profiles_file.string(),
                                 std::to_string(settings.num_frames),
                                 std::to_string(settings.mesh_bytes),
                                 std::to_string(settings.texture_bytes),
                                 std::to_string(settings.num_texture_writers)});
    if (!writer) return tl::unexpected(writer.error());
    stream->writer_ = std::move(*writer);
    for (HostedProcess* process : {stream->writer_.get(), stream->reader_.get()}) {
        if (!process->wait_for_output("matched", kPatience))
            return failed("they did not find each other", *process);
    }
    stream->there_before_ = network.counters(0, Way::kUp);
    stream->back_before_ = network.counters(1, Way::kUp);
    stream->started_ = std::chrono::steady_clock::now();
    return stream;
}

Expected<StreamReport> StreamOverLink::finish() {
    const auto duration = std::chrono::seconds(settings_.num_frames / 30);
    if (writer_->wait(duration + kPatience) != 0) return failed("the writer", *writer_);
    reader_->signal(SIGTERM);
    if (reader_->wait(kPatience) != 0) return failed("the reader", *reader_);
    StreamReport report;
    report.there = since(there_before_, network_.counters(0, Way::kUp));
    report.back = since(back_before_, network_.counters(1, Way::kUp));
    report.seconds =
        std::chrono::duration<double>(std::chrono::steady_clock::now() - started_).count();
    read_writes(writer_->output(), report);
    read_samples(reader_->output(), report);
    return report;
}

std::string table_head() {
    return fmt::format("{:<36}{:>9}{:>9}{:>9}{:>9}{:>8}{:>7}{:>7}{:>6}{:>7}{:>10}",
                       "stream",
                       "frames %",
                       "samples %",
                       "p50 [ms]",
                       "p99 [ms]",
                       "gap [ms]",
                       "kB/s",
                       "again",
                       "lost",
                       "queue",
                       "write [ms]");
}

std::string table_row(const std::string& name,
                      const StreamReport& report,
                      std::uint64_t num_frames) {
    const double seconds = static_cast<double>(num_frames) / 30;
    const double num_samples = static_cast<double>(kSamplesPerFrame * num_frames);
    return fmt::format(
        "{:<36}{:>9.1f}{:>9.1f}{:>9.1f}{:>9.1f}{:>8.0f}{:>7.0f}{:>7.0f}{:>6}{:>7}{:>10.2f}",
        name,
        100 * report.share_complete(),
        100 * static_cast<double>(report.num_samples) / num_samples,
        report.age_ms(0.5),
        report.age_ms(0.99),
        report.longest_gap_ms(),
        static_cast<double>(report.there.entered_bytes) / seconds / 1e3,
        static_cast<double>(report.retransmitted_bytes) / seconds / 1e3,
        report.there.lost,
        report.there.dropped_by_queue,
        report.write_ms_at(0.99));
}

}  // namespace atrium::test
