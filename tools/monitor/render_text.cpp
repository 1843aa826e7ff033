#include "tools/monitor/render_text.hpp"

#include "tools/monitor/text_lines.hpp"

#include <fmt/chrono.h>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <ctime>

namespace atrium::monitor {
namespace {

using bus::ProgramKind;
using status::spaced;

constexpr const char* kIndent = "  ";

std::string number_text(std::optional<double> number) {
    return number ? fmt::format("{:.1f}", *number) : "-";
}

std::string uptime_text(double uptime_s) {
    const auto total = static_cast<std::uint64_t>(std::clamp(uptime_s, 0.0, 1e12));
    const std::uint64_t days = total / 86400;
    return fmt::format("{}{}:{:02}:{:02}",
                       days > 0 ? fmt::format("{} d ", days) : "",
                       total / 3600 % 24,
                       total / 60 % 60,
                       total % 60);
}

std::string bytes_text(double bytes_per_s) {
    return bytes_per_s >= 1e6 ? fmt::format("{:.2f} MB/s", bytes_per_s / 1e6)
                              : fmt::format("{:.1f} kB/s", bytes_per_s / 1e3);
}

// "hull 3.1", "capture to display 51.0 (p99 60.2) +- 1.5", "capture to display 51.0?".
std::string latency_text(const Latency& latency) {
    if (latency.num_samples == 0) return spaced(latency.stage) + " -";
    const bool is_doubtful =
        latency.trust == ClockTrust::kUnsynchronised || latency.trust == ClockTrust::kUnknown;
    const char* mark = is_doubtful ? "?" : "";
    std::string text = fmt::format("{} {:.1f}{}", spaced(latency.stage), latency.median_ms, mark);
    if (latency.p99_ms) text += fmt::format(" (p99 {:.1f}{})", *latency.p99_ms, mark);
    if (latency.trust == ClockTrust::kSynchronised)
        text += fmt::format(" +- {:.1f}", latency.error_ms);
    return text;
}

std::vector<std::string> latency_texts(const std::vector<Latency>& latencies) {
    std::vector<std::string> texts;
    for (const Latency& latency : latencies) texts.push_back(latency_text(latency));
    return texts;
}

// Skips losses of zero.
std::vector<std::string> loss_texts(const std::vector<Count>& losses) {
    std::vector<std::string> texts;
    for (const Count& loss : losses) {
        if (loss.total == 0) continue;
        const std::string rate = loss.per_s > 0.0 ? fmt::format(" ({:.1f}/s)", *loss.per_s) : "";
        texts.push_back(fmt::format("{} {}{}", spaced(loss.what), loss.total, rate));
    }
    return texts;
}

Look look_of_losses(const std::vector<Count>& losses) {
    const bool grows = std::any_of(
        losses.begin(), losses.end(), [](const Count& loss) { return loss.per_s > 0.0; });
    return grows ? Look::kWarning : Look::kDim;
}

void add_title(const ProgramReport& program, TextLines& lines) {
    std::string text = fmt::format("{} {}", bus::kind_name(program.kind), program.name);
    if (program.is_known)
        text += fmt::format("  on {} pid {}, {}", program.host, program.pid, program.version);
    if (program.state == ProgramState::kGone) {
        text += fmt::format("  GONE for {:.0f} s", program.gone_s);
        if (!program.gone_reason.empty()) text += ": " + program.gone_reason;
        return lines.add(text, Look::kBad);
    }
    if (program.uptime_s) text += ", up " + uptime_text(*program.uptime_s);
    if (program.has_status)
        text += fmt::format(", {:.0f} MB", static_cast<double>(program.resident_bytes) / 1e6);
    if (program.state == ProgramState::kSilent) {
        text += fmt::format("  SILENT for {:.0f} s", program.silent_s);
        return lines.add(text, Look::kBad);
    }
    lines.add(text, Look::kTitle);
}

void add_rates(const ProgramReport& program, TextLines& lines) {
    std::vector<std::string> items{status::rate_text(program.rate, program.rate_unit)};
    for (const TopicRate& topic : program.topics) {
        std::string text = fmt::format("{} {}", topic.topic, bytes_text(topic.bytes_per_s));
        if (topic.samples_per_s)
            text += fmt::format(" {:.1f} samples/s, measured", *topic.samples_per_s);
        items.push_back(std::move(text));
    }
    lines.add_items(kIndent, items);
}

void add_stream_level(const bus::StreamState& stream, TextLines& lines) {
    std::vector<std::string> items{fmt::format("quality {}", stream.jpeg_quality),
                                   fmt::format("resolution 1/{}", stream.colour_divisor),
                                   fmt::format("rate 1/{}", stream.send_every)};
    if (stream.cap_bit_per_s > 0.0)
        items.push_back(fmt::format("cap {:.1f} Mbit/s", stream.cap_bit_per_s / 1e6));
    else
        items.emplace_back("no cap");
    if (!stream.cap_set_by.empty()) items.push_back("set by " + stream.cap_set_by);
    lines.add_items("  stream   ", items);
}

void add_notes(const ProgramReport& program, TextLines& lines) {
    if (program.notes.empty()) return;
    std::vector<std::string> items;
    for (const Figures::Note& note : program.notes) items.push_back(note.what + " " + note.text);
    lines.add_items(kIndent, items);
}

void add_cameras(const ProgramReport& program, TextLines& lines) {
    if (program.cameras.empty()) return;
    lines.add(fmt::format("  {:<12} {:>10} {:>8} {:>9}  {}",
                          "camera",
                          "pictures/s",
                          "age ms",
                          "offset ms",
                          "lost"),
              Look::kDim);
    for (const CameraReport& camera : program.cameras) {
        const bool has_picture = camera.last_picture_age_ms >= 0.0;
        const std::string age =
            has_picture ? fmt::format("{:.0f}", camera.last_picture_age_ms) : "-";
        const std::string head = fmt::format("  {:<12.20} {:>10} {:>8} {:>9.1f}  ",
                                             camera.name,
                                             number_text(camera.received.per_s),
                                             age,
                                             camera.offset_ms);
        std::vector<std::string> items = loss_texts(camera.losses);
        Look look = look_of_losses(camera.losses) == Look::kWarning ? Look::kWarning : Look::kPlain;
        if (!camera.connected) {
            items.insert(items.begin(), "NOT CONNECTED");
            look = Look::kBad;
        }
        if (items.empty()) items.emplace_back("-");
        lines.add_items(head, items, look);
    }
}

void add_stream(const StreamReport& stream, TextLines& lines) {
    std::vector<std::string> items{number_text(stream.complete.per_s) + " frames/s",
                                   bytes_text(stream.payload_bytes_per_s)};
    for (std::string& text : latency_texts(stream.delays)) items.push_back(std::move(text));
    if (stream.is_silent) items = {"no feedback for some seconds"};
    std::vector<std::string> losses = loss_texts(stream.losses);
    if (!losses.empty()) losses.front() = "lost " + losses.front();
    items.insert(items.end(), losses.begin(), losses.end());
    const bool is_bad = look_of_losses(stream.losses) == Look::kWarning || stream.is_silent;
    lines.add_items(
        fmt::format("  from {}  ", stream.site), items, is_bad ? Look::kWarning : Look::kPlain);
}

void add_program(const Report& report,
                 const ProgramReport& program,
                 bool with_cameras,
                 TextLines& lines) {
    add_title(program, lines);
    if (program.state == ProgramState::kGone) return;
    if (program.has_status) {
        add_rates(program, lines);
        lines.add_items("  ms       ", latency_texts(program.latencies));
        lines.add_items("  cpu      ", status::processor_items(program.processor));
        if (program.stream) add_stream_level(*program.stream, lines);
        if (program.coherence && !status::rig_items(*program.coherence).empty())
            lines.add_items("  rig      ", status::rig_items(*program.coherence));
        add_notes(program, lines);
        lines.add_items("  lost     ", loss_texts(program.losses), look_of_losses(program.losses));
        for (const Figures::Alarm& alarm : program.alarms)
            lines.add_words("  mend     ", alarm.what + ": " + alarm.cure, Look::kWarning);
        for (const status::Bottleneck& found : program.bottlenecks)
            lines.add_words("  slow     ", found.text, Look::kWarning);
    } else if (program.kind != ProgramKind::kOther) {
        lines.add("  no status yet", Look::kDim);
    }
    if (with_cameras) add_cameras(program, lines);
    for (const StreamReport& stream : report.streams) {
        if (program.kind == ProgramKind::kViewer && stream.viewer == program.name)
            add_stream(stream, lines);
    }
}

std::size_t num_of(const Report& report, ProgramKind kind) {
    return static_cast<std::size_t>(std::count_if(
        report.programs.begin(), report.programs.end(), [&](const ProgramReport& program) {
            return program.kind == kind && program.state != ProgramState::kGone;
        }));
}

// Warns about names on the command line that no site has; they may be misspelt.
void add_unknown_sites(const Report& report,
                       const std::vector<std::string>& names,
                       TextLines& lines) {
    std::vector<std::string> there;
    for (const ProgramReport& program : report.programs)
        if (program.kind == ProgramKind::kSiteNode) there.push_back(program.name);
    for (const std::string& name : names) {
        if (std::find(there.begin(), there.end(), name) != there.end()) continue;
        lines.add_words(
            "! ",
            fmt::format("no site '{}' is there{}",
                        name,
                        there.empty() ? ", nor any other"
                                      : fmt::format("; there are: {}", fmt::join(there, ", "))),
            Look::kWarning);
    }
}

TextLines render(const Report& report, const TextOptions& options, bool with_all_cameras) {
    TextLines lines(std::max(options.width, kMinWidth), options.colour);
    const std::time_t time = report.time.ns / 1'000'000'000;
    lines.add_items("",
                    {"world " + report.world,
                     fmt::format("{:%H:%M:%S}Z", fmt::gmtime(time)),
                     fmt::format("sites {}", num_of(report, ProgramKind::kSiteNode)),
                     fmt::format("world servers {}", num_of(report, ProgramKind::kWorldServer)),
                     fmt::format("viewers {}", num_of(report, ProgramKind::kViewer)),
                     fmt::format("others {}", num_of(report, ProgramKind::kOther))},
                    Look::kTitle);
    for (const std::string& notice : report.notices) {
        lines.add_words("! ", notice, Look::kWarning);
    }
    add_unknown_sites(report, options.sites, lines);
    if (report.programs.empty()) lines.add("nobody is there", Look::kWarning);
    for (const ProgramReport& program : report.programs) {
        const bool is_named = program.kind == ProgramKind::kSiteNode &&
                              std::find(options.sites.begin(), options.sites.end(), program.name) !=
                                  options.sites.end();
        lines.add("");
        add_program(report, program, with_all_cameras || is_named, lines);
    }
    return lines;
}

}  // namespace

std::vector<std::string> render_text(const Report& report, const TextOptions& options) {
    // with --site, cameras of other sites are not wanted
    TextLines lines = render(report, options, options.sites.empty());
    if (options.height > 0 && lines.size() > options.height) {
        lines = render(report, options, false);
        lines.cut(options.height);
    }
    return lines.take();
}

}  // namespace atrium::monitor
