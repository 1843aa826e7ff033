#include "tools/monitor/world_model.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace atrium::monitor {
namespace {

using bus::ProgramKind;

double seconds(std::chrono::nanoseconds duration) {
    return std::chrono::duration<double>(duration).count();
}

// Rates need two statuses of one process, with some time between them on its clock.
std::optional<double> seconds_between(const std::optional<Figures>& before, const Figures& now) {
    if (!before) return {};
    const double elapsed_s = seconds(now.time - before->time);
    if (elapsed_s < 0.01) return {};
    return elapsed_s;
}

Count count(const std::string& what,
            std::uint64_t total,
            std::optional<std::uint64_t> former,
            std::optional<double> elapsed_s) {
    Count out{what, total, {}};
    if (former && elapsed_s && total >= *former)
        out.per_s = static_cast<double>(total - *former) / *elapsed_s;
    return out;
}

std::vector<Count> counts(const std::vector<Counter>& now,
                          const std::vector<Counter>* before,
                          std::optional<double> elapsed_s) {
    std::vector<Count> list;
    for (std::size_t i = 0; i < now.size(); ++i) {
        std::optional<std::uint64_t> former;
        if (before != nullptr && i < before->size()) former = (*before)[i].total;
        list.push_back(count(now[i].what, now[i].total, former, elapsed_s));
    }
    return list;
}

// A viewer short of processor time can make a site assume a slow network. Names it as the cause.
void blame_slow_viewers(std::vector<ProgramReport>& programs) {
    for (ProgramReport& site : programs) {
        if (site.kind != ProgramKind::kSiteNode || !site.stream) continue;
        const auto viewer = std::ranges::find_if(programs, [&](const ProgramReport& program) {
            return program.kind == ProgramKind::kViewer &&
                   program.name == site.stream->cap_set_by &&
                   status::is_short_of_processor(program.processor);
        });
        if (viewer == programs.end()) continue;
        for (status::Bottleneck& found : site.bottlenecks) {
            if (found.cause == status::Cause::kNetwork)
                found.text += ", but the machine of that viewer is too slow";
        }
    }
}

bool is_node(const ProgramReport& program) {
    return (program.kind == ProgramKind::kCameraNode || program.kind == ProgramKind::kRegionNode) &&
           program.state != ProgramState::kGone;
}

// A host that its site misses, although its program is there: it has no pictures yet.
void excuse(const ProgramReport& node, ProgramReport& site) {
    if (node.has_status) return;
    const std::string host = node.name.substr(site.name.size() + 1);
    for (Figures::Alarm& alarm : site.alarms) {
        if (!alarm.what.starts_with(fmt::format("host {} is left out: nothing comes", host)))
            continue;
        alarm.advice = "it prepares its pictures";
        alarm.cure = "wait: camera_node runs there, and prepares its pictures";
    }
}

// Compares nodes of a site on several hosts with its model part. Their names begin with that of the
// site.
void compare_with_model_parts(std::vector<ProgramReport>& programs) {
    for (ProgramReport& node : programs) {
        if (!is_node(node)) continue;
        const auto site = std::ranges::find_if(programs, [&](const ProgramReport& program) {
            return program.kind == ProgramKind::kSiteNode &&
                   program.state == ProgramState::kPresent &&
                   node.name.starts_with(program.name + ".");
        });
        if (site == programs.end()) {
            if (node.has_status)
                node.alarms.push_back({"the model part of its site is missing",
                                       "is site_node running there?",
                                       "start site_node on the host with model = true, and check "
                                       "its network"});
            continue;
        }
        excuse(node, *site);
        const std::string host = node.name.substr(site->name.size() + 1);
        const bool is_named =
            std::ranges::find(site->hosts, host, &bus::HostStatus::name) != site->hosts.end();
        if (site->has_status && !is_named)
            node.alarms.push_back(
                {"the file of its site's model part does not name this host",
                 "use one file on all hosts",
                 "copy the site's file from the host of the model part, and start "
                 "the programs there anew"});
    }
}

}  // namespace

std::size_t Report::num_here() const {
    return static_cast<std::size_t>(
        std::count_if(programs.begin(), programs.end(), [](const ProgramReport& program) {
            return program.state != ProgramState::kGone;
        }));
}

std::optional<HostClock> WorldModel::clock_of(ProgramKind kind, const std::string& name) const {
    const auto found = programs_.find({kind, name});
    if (found == programs_.end() || !found->second.last_presence) return {};
    const bus::Presence& presence = *found->second.last_presence;
    return HostClock{presence.host,
                     presence.is_clock_synchronised,
                     std::chrono::duration<double, std::milli>(presence.clock_max_error).count()};
}

// Compares the clocks of a site and a program. Adds a notice if the result means nothing.
Comparison WorldModel::compare_with_site(const std::string& site,
                                         ProgramKind kind,
                                         const std::string& name) {
    const auto site_clock = clock_of(ProgramKind::kSiteNode, site);
    const auto other_clock = clock_of(kind, name);
    const Comparison compared = compare(site_clock, other_clock);
    if (report_notices_.size() >= kMaxNotices) return compared;
    if (compared.trust == ClockTrust::kUnsynchronised)
        report_notices_.insert(unsynchronised_notice(*site_clock, *other_clock));
    if (compared.trust == ClockTrust::kUnknown) {
        report_notices_.insert(
            fmt::format("the host of {} '{}' is unknown, so latencies may compare two clocks",
                        bus::kind_name(site_clock ? kind : ProgramKind::kSiteNode),
                        site_clock ? name : site));
    }
    return compared;
}

void WorldModel::put_latencies(const ProgramKey& key, const Figures& figures, ProgramReport& out) {
    for (const Figures::Stage& stage : figures.stages) {
        Comparison compared;
        for (auto site = programs_.lower_bound({ProgramKind::kSiteNode, ""});
             stage.is_from_capture_elsewhere && stage.latency.num_samples > 0 &&
             site != programs_.end() && site->first.first == ProgramKind::kSiteNode;
             ++site) {
            if (!site->second.gone_at)
                compared =
                    worse(compared, compare_with_site(site->first.second, key.first, key.second));
        }
        Latency latency{.stage = stage.name,
                        .median_ms = stage.latency.median_ms,
                        .p99_ms = {},
                        .num_samples = stage.latency.num_samples,
                        .trust = compared.trust,
                        .error_ms = compared.error_ms};
        if (stage.has_p99) latency.p99_ms = stage.latency.p99_ms;
        out.latencies.push_back(std::move(latency));
    }
}

void WorldModel::put_figures(const Program& program, ProgramReport& out) {
    const Figures& now = *program.figures;
    const auto elapsed_s = seconds_between(program.before, now);
    const Figures* before = program.before ? &*program.before : nullptr;
    out.has_status = true;
    out.rate_unit = now.rate_unit;
    out.rate = now.rate;
    out.work = counts(now.work, before != nullptr ? &before->work : nullptr, elapsed_s);
    out.losses = counts(now.losses, before != nullptr ? &before->losses : nullptr, elapsed_s);
    for (const Figures::Topic& topic : now.topics)
        out.topics.push_back({topic.name, topic.bytes_per_s, {}, false});
    for (std::size_t i = 0; i < now.cameras.size(); ++i) {
        const bus::CameraStatus& camera = now.cameras[i].status;
        const Figures::Camera* former = before != nullptr ? &before->cameras[i] : nullptr;
        std::optional<std::uint64_t> former_received;
        if (former != nullptr) former_received = former->status.num_received;
        out.cameras.push_back(
            {camera.name,
             camera.connected,
             count("received", camera.num_received, former_received, elapsed_s),
             camera.offset_ms,
             camera.last_picture_age_ms,
             counts(
                 now.cameras[i].losses, former != nullptr ? &former->losses : nullptr, elapsed_s)});
    }
    out.stream = now.stream;
    out.coherence = now.coherence;
    out.alarms = now.alarms;
    out.hosts = now.hosts;
    out.notes = now.notes;
    out.resident_bytes = now.resident_bytes;
    out.processor = now.processor;
    out.first_output_s = now.first_output_s;
    out.bottlenecks = status::bottlenecks(program.before, now);
}

ProgramReport WorldModel::report_of(const ProgramKey& key,
                                    const Program& program,
                                    Clock::time_point now,
                                    Timestamp time) {
    ProgramReport out;
    out.kind = key.first;
    out.name = key.second;
    if (program.last_presence) {
        const bus::Presence& presence = *program.last_presence;
        out.is_known = true;
        out.host = presence.host;
        out.pid = presence.pid;
        out.version = presence.version;
        out.clock = ClockReport{
            presence.is_clock_synchronised,
            std::chrono::duration<double, std::milli>(presence.clock_max_error).count()};
        // on its own clock, if known
        const Timestamp its_time =
            program.figures ? program.figures->time + (now - program.figures_at) : time;
        out.uptime_s = std::max(0.0, seconds(its_time - presence.start_time));
        if (program.instances.size() > 1 && report_notices_.size() < kMaxNotices) {
            report_notices_.insert(fmt::format("{} processes claim the name of {} '{}'",
                                               program.instances.size(),
                                               kind_name(key.first),
                                               key.second));
        }
    }
    if (program.gone_at) {
        out.state = ProgramState::kGone;
        out.gone_s = seconds(now - *program.gone_at);
        out.gone_reason = program.gone_reason;
        return out;
    }
    if (program.figures) {
        put_figures(program, out);
        put_latencies(key, *program.figures, out);
        out.silent_s = seconds(now - program.figures_at);
        if (now - program.figures_at >= kSilence) out.state = ProgramState::kSilent;
    }
    for (const auto& [topic, rates] : program.measured) {
        std::erase_if(out.topics, [&](const TopicRate& rate) { return rate.topic == topic; });
        out.topics.push_back({topic, rates.bytes.per_s(now), rates.samples.per_s(now), true});
    }
    return out;
}

StreamReport WorldModel::report_of(const std::pair<std::string, std::string>& key,
                                   const Stream& stream,
                                   Clock::time_point now) {
    StreamReport out;
    out.viewer = key.first;
    out.site = key.second;
    out.is_silent = now - stream.seen_at >= kSilence;
    out.payload_bytes_per_s = stream.newest.payload_bytes_per_s;
    for (const auto& [what, counted] : stream.counts) {
        Count one{what, counted.first, counted.second.per_s(now)};
        if (what == "complete")
            out.complete = std::move(one);
        else
            out.losses.push_back(std::move(one));
    }
    const Comparison compared = compare_with_site(key.second, ProgramKind::kViewer, key.first);
    const auto add = [&](const char* stage, double ms, std::uint64_t num_samples) {
        out.delays.push_back({stage, ms, {}, num_samples, compared.trust, compared.error_ms});
    };
    add("sent_to_arrival_least", stream.newest.min_delay_ms, stream.newest.num_samples);
    add("capture_to_complete", stream.newest.median_delay_ms, stream.newest.num_complete);
    return out;
}

Report WorldModel::report(Clock::time_point now, Timestamp time) {
    forget_the_gone(now);
    report_notices_.clear();
    Report report;
    report.world = world_;
    report.time = time;
    for (const auto& [key, program] : programs_)
        report.programs.push_back(report_of(key, program, now, time));
    blame_slow_viewers(report.programs);
    compare_with_model_parts(report.programs);
    for (const auto& [key, stream] : streams_)
        report.streams.push_back(report_of(key, stream, now));
    report.notices.assign(report_notices_.begin(), report_notices_.end());
    for (const auto& [when, line] : notices_) report.notices.push_back(line);
    report.num_left_out = num_left_out_;
    if (num_left_out_ > 0) {
        report.notices.push_back(
            fmt::format("no room for all programs and streams: ignored {} times", num_left_out_));
    }
    return report;
}

}  // namespace atrium::monitor
