#include "tools/monitor/render_json.hpp"

#include <nlohmann/json.hpp>

#include <algorithm>

namespace atrium::monitor {
namespace {

using nlohmann::ordered_json;

constexpr const char* kKinds[] = {
    "site", "world_server", "viewer", "other", "camera_node", "region_node"};
constexpr const char* kStates[] = {"present", "silent", "gone"};
constexpr const char* kTrusts[] = {"one_clock", "synchronised", "unsynchronised", "unknown"};

ordered_json count_json(const Count& count) {
    return {{"total", count.total},
            {"per_s", count.per_s ? ordered_json(*count.per_s) : ordered_json()}};
}

ordered_json counts_json(const std::vector<Count>& counts) {
    ordered_json out = ordered_json::object();
    for (const Count& count : counts) out[count.what] = count_json(count);
    return out;
}

ordered_json latencies_json(const std::vector<Latency>& latencies) {
    ordered_json out = ordered_json::object();
    for (const Latency& latency : latencies) {
        ordered_json one;
        const bool is_there = latency.num_samples > 0;
        one["median_ms"] = is_there ? ordered_json(latency.median_ms) : ordered_json();
        one["p99_ms"] = is_there && latency.p99_ms ? ordered_json(*latency.p99_ms) : ordered_json();
        one["clocks"] = kTrusts[static_cast<std::size_t>(latency.trust)];
        const bool has_error = latency.trust <= ClockTrust::kSynchronised;
        one["clock_error_ms"] = has_error ? ordered_json(latency.error_ms) : ordered_json();
        out[latency.stage] = std::move(one);
    }
    return out;
}

ordered_json topics_json(const std::vector<TopicRate>& topics) {
    ordered_json out = ordered_json::object();
    for (const TopicRate& topic : topics) {
        out[topic.topic] = {
            {"bytes_per_s", topic.bytes_per_s},
            {"samples_per_s",
             topic.samples_per_s ? ordered_json(*topic.samples_per_s) : ordered_json()},
            {"source", topic.is_measured ? "measured" : "reported"}};
    }
    return out;
}

ordered_json cameras_json(const std::vector<CameraReport>& cameras) {
    ordered_json out = ordered_json::array();
    for (const CameraReport& camera : cameras) {
        const bool has_picture = camera.last_picture_age_ms >= 0.0;
        out.push_back({{"name", camera.name},
                       {"connected", camera.connected},
                       {"received", count_json(camera.received)},
                       {"last_picture_age_ms",
                        has_picture ? ordered_json(camera.last_picture_age_ms) : ordered_json()},
                       {"offset_ms", camera.offset_ms},
                       {"losses", counts_json(camera.losses)}});
    }
    return out;
}

ordered_json stream_level_json(const std::optional<bus::StreamState>& stream) {
    if (!stream) return nullptr;
    const bool has_cap = stream->cap_bit_per_s > 0.0;
    return {{"jpeg_quality", stream->jpeg_quality},
            {"colour_divisor", stream->colour_divisor},
            {"send_every", stream->send_every},
            {"cap_bit_per_s", has_cap ? ordered_json(stream->cap_bit_per_s) : ordered_json()},
            {"cap_set_by", stream->cap_set_by}};
}

ordered_json processor_json(const ProgramReport& program) {
    const ProcessorUse& use = program.processor;
    const auto waited = [&](double seconds) {
        return program.has_status && use.is_waiting_known ? ordered_json(seconds) : ordered_json();
    };
    const auto known = [&](auto value) {
        return program.has_status ? ordered_json(value) : ordered_json();
    };
    return {{"cores", known(use.run_per_s)},
            {"run_s", known(1e-9 * static_cast<double>(use.run_ns))},
            {"waited_s", waited(1e-9 * static_cast<double>(use.waited_ns))},
            {"waited_per_s", waited(use.waited_per_s)},
            {"longest_wait_per_s", waited(use.longest_wait_per_s)},
            {"nice", known(use.nice)}};
}

ordered_json bottlenecks_json(const std::vector<status::Bottleneck>& bottlenecks) {
    ordered_json out = ordered_json::array();
    for (const status::Bottleneck& found : bottlenecks)
        out.push_back({{"cause", status::name_of(found.cause)}, {"text", found.text}});
    return out;
}

ordered_json fault_json(const bus::RigCoherence& coherence) {
    if (!coherence.has_fault() || coherence.fault.camera >= coherence.cameras.size())
        return nullptr;
    const bus::RigFault& fault = coherence.fault;
    const auto certain = [](double value) {
        return value < 0.0 ? ordered_json() : ordered_json(value);
    };
    return {{"camera", coherence.cameras[fault.camera].name},
            {"turned_deg", certain(fault.turned_deg)},
            {"moved_mm", certain(fault.moved_mm)},
            {"is_either", fault.is_either},
            {"late_instants", fault.late_instants},
            {"effect_px", fault.effect_px},
            {"cure", fault.cure}};
}

ordered_json coherence_json(const std::optional<bus::RigCoherence>& coherence) {
    if (!coherence) return nullptr;
    ordered_json cameras = ordered_json::array();
    for (const bus::CameraCoherence& camera : coherence->cameras)
        cameras.push_back({{"name", camera.name},
                           {"rms_px", camera.rms_px},
                           {"share", camera.share},
                           {"tangencies", camera.num_tangencies}});
    const bool is_judged = coherence->verdict != bus::RigVerdict::kUnknown;
    return {{"verdict", status::name_of(coherence->verdict)},
            {"rms_px", is_judged ? ordered_json(coherence->rms_px) : ordered_json()},
            {"instants", coherence->num_instants},
            {"cameras", std::move(cameras)},
            {"fault", fault_json(*coherence)}};
}

ordered_json hosts_json(const std::vector<bus::HostStatus>& hosts) {
    ordered_json list = ordered_json::array();
    for (const bus::HostStatus& host : hosts)
        list.push_back({{"name", host.name},
                        {"state", status::name_of(host.state)},
                        {"clock_offset_ms", host.clock_offset_ms},
                        {"clock_error_ms", host.clock_error_ms},
                        {"num_cameras", host.num_cameras},
                        {"num_regions", host.num_regions},
                        {"num_left_out", host.num_left_out}});
    return list;
}

ordered_json alarms_json(const std::vector<Figures::Alarm>& alarms) {
    ordered_json out = ordered_json::array();
    for (const Figures::Alarm& alarm : alarms)
        out.push_back({{"text", alarm.what}, {"cure", alarm.cure}});
    return out;
}

ordered_json program_json(const ProgramReport& program) {
    ordered_json out;
    out["kind"] = kKinds[std::min<std::size_t>(static_cast<std::size_t>(program.kind),
                                               std::size(kKinds) - 1)];
    out["name"] = program.name;
    out["state"] = kStates[static_cast<std::size_t>(program.state)];
    const bool is_gone = program.state == ProgramState::kGone;
    out["gone_s"] = is_gone ? ordered_json(program.gone_s) : ordered_json();
    out["gone_reason"] = program.gone_reason;
    out["host"] = program.is_known ? ordered_json(program.host) : ordered_json();
    out["pid"] = program.is_known ? ordered_json(program.pid) : ordered_json();
    out["version"] = program.is_known ? ordered_json(program.version) : ordered_json();
    out["uptime_s"] = program.uptime_s ? ordered_json(*program.uptime_s) : ordered_json();
    out["clock"] = nullptr;
    if (program.clock) {
        out["clock"] = {{"synchronised", program.clock->is_synchronised},
                        {"max_error_ms", program.clock->max_error_ms}};
    }
    out["status_age_s"] = program.has_status ? ordered_json(program.silent_s) : ordered_json();
    out["rate"] = program.has_status ? ordered_json(program.rate) : ordered_json();
    out["rate_unit"] = program.rate_unit;
    out["work"] = counts_json(program.work);
    out["losses"] = counts_json(program.losses);
    out["latencies"] = latencies_json(program.latencies);
    out["topics"] = topics_json(program.topics);
    out["stream_level"] = stream_level_json(program.stream);
    out["notes"] = ordered_json::object();
    for (const Figures::Note& note : program.notes) out["notes"][note.what] = note.text;
    out["cameras"] = cameras_json(program.cameras);
    out["coherence"] = coherence_json(program.coherence);
    out["hosts"] = hosts_json(program.hosts);
    out["alarms"] = alarms_json(program.alarms);
    out["resident_bytes"] =
        program.has_status ? ordered_json(program.resident_bytes) : ordered_json();
    out["processor"] = processor_json(program);
    out["first_output_s"] =
        program.first_output_s > 0.0 ? ordered_json(program.first_output_s) : ordered_json();
    out["bottlenecks"] = bottlenecks_json(program.bottlenecks);
    return out;
}

ordered_json stream_json(const StreamReport& stream) {
    return {{"viewer", stream.viewer},
            {"site", stream.site},
            {"silent", stream.is_silent},
            {"payload_bytes_per_s", stream.payload_bytes_per_s},
            {"complete", count_json(stream.complete)},
            {"losses", counts_json(stream.losses)},
            {"latencies", latencies_json(stream.delays)}};
}

}  // namespace

std::string render_json(const Report& report) {
    ordered_json out;
    out["world"] = report.world;
    out["time_ns"] = report.time.ns;
    out["num_here"] = report.num_here();
    out["num_left_out"] = report.num_left_out;
    out["notices"] = report.notices;
    out["programs"] = ordered_json::array();
    for (const ProgramReport& program : report.programs)
        out["programs"].push_back(program_json(program));
    out["streams"] = ordered_json::array();
    for (const StreamReport& stream : report.streams) out["streams"].push_back(stream_json(stream));
    // invalid UTF-8 is replaced, not thrown
    return out.dump(-1, ' ', /*ensure_ascii=*/true, ordered_json::error_handler_t::replace);
}

}  // namespace atrium::monitor
