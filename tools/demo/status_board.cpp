#include "tools/demo/status_board.hpp"

#include "core/status/bottleneck.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <functional>

namespace atrium::demo {
namespace {

using nlohmann::ordered_json;

// Keeps samples of about one day and drops the oldest.
constexpr std::size_t kMaxSamples = 100'000;
constexpr std::size_t kTableWidth = 115;

template <typename Status, typename Value>
double median(const std::vector<Status>& samples, Value value) {
    std::vector<double> values;
    for (const Status& s : samples) values.push_back(static_cast<double>(std::invoke(value, s)));
    if (values.empty()) return 0.0;
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
}

template <typename Status, typename Value>
auto difference(const std::vector<Status>& samples, Value value) {
    return samples.empty()
               ? 0
               : std::invoke(value, samples.back()) - std::invoke(value, samples.front());
}

// Median of the medians of each second, and the 99th percentile of the worst second: an upper
// bound.
template <typename Status, typename Latency>
ordered_json latency_json(const std::vector<Status>& samples, Latency latency) {
    double worst = 0.0;
    for (const Status& s : samples) worst = std::max(worst, std::invoke(latency, s).p99_ms);
    return {{"median",
             median(samples, [&](const Status& s) { return std::invoke(latency, s).median_ms; })},
            {"p99", worst}};
}

std::uint64_t num_dropped(const bus::SiteStatus& s) {
    return s.num_dropped_incomplete + s.num_dropped_late + s.stream.num_dropped_for_rate +
           s.num_failed;
}

template <typename History, typename Status>
void keep(History& history, const std::string& name, Status&& status) {
    history.name = name;
    if (history.samples.size() == kMaxSamples) history.samples.erase(history.samples.begin());
    history.samples.push_back(std::forward<Status>(status));
}

double mega(double v) { return v / 1e6; }

double seconds(std::uint64_t ns) { return 1e-9 * static_cast<double>(ns); }

// Processor use between the first and the last report; `done` is the number of results in that
// time.
template <typename Status>
ordered_json processor_json(const std::vector<Status>& samples,
                            const char* per_thing,
                            std::uint64_t done) {
    if (samples.empty()) return nullptr;
    const ProcessorUse& first = samples.front().processor;
    const ProcessorUse& last = samples.back().processor;
    const double elapsed_s =
        1e-9 * static_cast<double>((samples.back().time - samples.front().time).count());
    const double run_s = seconds(last.run_ns - std::min(first.run_ns, last.run_ns));
    const double waited_s = seconds(last.waited_ns - std::min(first.waited_ns, last.waited_ns));
    const bool is_known = last.is_waiting_known;
    const auto per = [](double value, double divisor) {
        return divisor > 0.0 ? ordered_json(value / divisor) : ordered_json();
    };
    const auto waited = [&](ordered_json value) { return is_known ? value : ordered_json(); };
    ordered_json out;
    out["run_s"] = run_s;
    out["waited_s"] = waited(waited_s);
    out["cores"] = per(run_s, elapsed_s);
    out["waited_per_s"] = waited(per(waited_s, elapsed_s));
    out["longest_wait_per_s"] =
        waited(median(samples, [](const Status& s) { return s.processor.longest_wait_per_s; }));
    out[per_thing] = per(1e3 * run_s, static_cast<double>(done));
    out["run_s_since_start"] = seconds(last.run_ns);
    out["waited_s_since_start"] = waited(seconds(last.waited_ns));
    out["nice"] = last.nice;
    return out;
}

template <typename Status>
void add_process(ordered_json& out,
                 const std::vector<Status>& samples,
                 const char* per_thing,
                 std::uint64_t done) {
    const bool has_output = !samples.empty() && samples.back().first_output_s > 0.0;
    out["resident_bytes"] = samples.empty() ? 0 : samples.back().resident_bytes;
    out["resident_bytes_at_start"] = samples.empty() ? 0 : samples.front().resident_bytes;
    out["processor"] = processor_json(samples, per_thing, done);
    out["first_output_s"] = has_output ? ordered_json(samples.back().first_output_s) : nullptr;
}

// "0.81  43%": cores used, and the share of time that the longest-waiting thread waited.
std::string processor_text(const ProcessorUse& use) {
    const std::string waited =
        use.is_waiting_known ? fmt::format("{:.0f}%", 100.0 * use.longest_wait_per_s) : "?";
    return fmt::format("{:.2f} {:>4}", use.run_per_s, waited);
}

// Bottlenecks of the program in its last second.
template <typename Status>
void add_bottlenecks(const std::string& name,
                     const std::vector<Status>& samples,
                     std::vector<std::string>& lines) {
    if (samples.empty()) return;
    std::optional<status::Figures> before;
    if (samples.size() > 1) before = status::figures_of(samples[samples.size() - 2]);
    for (const status::Bottleneck& found :
         status::bottlenecks(before, status::figures_of(samples.back())))
        lines.push_back(fmt::format("{:<12} {}", name, found.text));
}

}  // namespace

Expected<StatusBoard> StatusBoard::create(const bus::Participant& participant) {
    auto sites = bus::Reader<bus::SiteStatus>::create(participant);
    if (!sites) return tl::unexpected(sites.error());
    auto world = bus::Reader<bus::WorldStatus>::create(participant);
    if (!world) return tl::unexpected(world.error());
    auto viewer = bus::Reader<bus::ViewerStatus>::create(participant);
    if (!viewer) return tl::unexpected(viewer.error());
    return StatusBoard(std::move(*sites), std::move(*world), std::move(*viewer));
}

void StatusBoard::attach(bus::Waiter& waiter) const {
    waiter.add(site_reader_);
    waiter.add(world_reader_);
    waiter.add(viewer_reader_);
}

bool StatusBoard::update() {
    const std::size_t num_taken =
        site_reader_.take([&](bus::SiteStatus&& s) { keep(sites_[s.site], s.site, s); }).num_taken +
        world_reader_.take([&](bus::WorldStatus&& s) { keep(world_, s.world, s); }).num_taken +
        viewer_reader_.take([&](bus::ViewerStatus&& s) { keep(viewer_, s.viewer, s); }).num_taken;
    return num_taken > 0;
}

void StatusBoard::begin_report() {
    for (auto& [name, history] : sites_) history.samples.clear();
    world_.samples.clear();
    viewer_.samples.clear();
}

bool StatusBoard::site_publishes(const std::string& site) const {
    const auto it = sites_.find(site);
    return it != sites_.end() && !it->second.samples.empty() &&
           it->second.samples.back().num_metaframes_published > 0;
}

std::uint64_t StatusBoard::num_pairs_shown() const {
    return viewer_.samples.empty() ? 0 : viewer_.samples.back().num_pairs_shown;
}

std::vector<std::string> StatusBoard::table(const std::map<std::string, std::string>& notes) const {
    std::vector<std::string> lines;
    const auto row = [&](const std::string& name,
                         const std::string& rate,
                         const std::string& latency,
                         const std::string& bytes,
                         const std::string& dropped,
                         const std::string& processor,
                         const std::string& memory) {
        lines.push_back(fmt::format("{:<12} {:>18} {:>30} {:>6} {:>27} {:>10} {:>6}",
                                    name,
                                    rate,
                                    latency,
                                    bytes,
                                    dropped,
                                    processor,
                                    memory));
    };
    const auto program = [&](const std::string& name,
                             const char* done,
                             const status::Figures& figures,
                             const std::string& bytes,
                             const std::string& dropped) {
        const bus::LatencySummary& latency = figures.stages.back().latency;  // since capture
        row(name,
            status::rate_text(figures.rate, figures.rate_unit),
            fmt::format("{} {:>6.1f} {:>6.1f}", done, latency.median_ms, latency.p99_ms),
            bytes,
            dropped,
            processor_text(figures.processor),
            fmt::format("{:.0f}", mega(static_cast<double>(figures.resident_bytes))));
    };
    row("program", "rate", "ms since capture: median p99", "MB/s", "dropped", "cores wait", "MB");
    for (const auto& [name, history] : sites_) {
        if (history.samples.empty()) continue;
        const bus::SiteStatus& s = history.samples.back();
        program(name,
                "published",
                status::figures_of(s),
                fmt::format("{:.2f}", mega(s.bytes_per_s)),
                fmt::format("{} inc {} late {} rate {} bad",
                            s.num_dropped_incomplete,
                            s.num_dropped_late,
                            s.stream.num_dropped_for_rate,
                            s.num_failed));
    }
    if (!world_.samples.empty()) {
        const bus::WorldStatus& s = world_.samples.back();
        program("world",
                "touched",
                status::figures_of(s),
                "",
                fmt::format("{} rejected", s.num_rejected));
    }
    if (!viewer_.samples.empty()) {
        const bus::ViewerStatus& s = viewer_.samples.back();
        program("viewer",
                "displayed",
                status::figures_of(s),
                "",
                fmt::format("{} skipped {} inc", s.num_pairs_skipped, s.num_incomplete));
    }
    for (const auto& [name, history] : sites_) add_bottlenecks(name, history.samples, lines);
    add_bottlenecks("world", world_.samples, lines);
    add_bottlenecks("viewer", viewer_.samples, lines);
    for (const auto& [name, note] : notes) lines.push_back(fmt::format("{:<12} {}", name, note));
    for (std::string& line : lines) line = fmt::format("{0:<{1}.{1}}", line, kTableWidth);
    return lines;
}

std::string StatusBoard::report(const Run& run) const {
    ordered_json root;
    root["seconds"] = run.measured_s;
    root["seconds_until_everybody_was_on"] = run.until_everybody_was_on_s;
    root["note"] =
        "rates and latencies: median over the seconds of the run; p99: that of its worst second; "
        "processor: of the run; first_output_s: from the start of the process";
    for (const auto& [name, history] : sites_) {
        const auto& samples = history.samples;
        using S = bus::SiteStatus;
        ordered_json site;
        site["metaframes_per_s"] = median(samples, &S::metaframes_per_s);
        site["capture_to_publish_ms"] = latency_json(samples, &S::capture_to_publish);
        site["bytes_per_s"] = median(samples, &S::bytes_per_s);
        site["metaframes_published"] = difference(samples, &S::num_metaframes_published);
        site["dropped"] = difference(samples, num_dropped);
        site["dropped_incomplete"] = difference(samples, &S::num_dropped_incomplete);
        site["dropped_late"] = difference(samples, &S::num_dropped_late);
        site["dropped_for_rate"] =
            difference(samples, [](const S& s) { return s.stream.num_dropped_for_rate; });
        site["failed"] = difference(samples, &S::num_failed);
        site["hulls_lacked"] = {
            {"cameras", difference(samples, [](const S& s) { return s.left_out.num_cameras; })},
            {"phantoms", difference(samples, [](const S& s) { return s.left_out.num_phantoms; })},
            {"fragments", difference(samples, [](const S& s) { return s.left_out.num_fragments; })},
        };
        add_process(site,
                    samples,
                    "run_ms_per_metaframe",
                    difference(samples, &S::num_metaframes_published));
        root["sites"][name] = std::move(site);
    }
    {
        using W = bus::WorldStatus;
        const auto& samples = world_.samples;
        ordered_json& world = root["world"];
        world["steps_per_s"] = median(samples, &W::steps_per_s);
        world["steps_with_contact"] = difference(samples, &W::num_contacts);
        world["meshes_received"] = difference(samples, &W::num_meshes_received);
        world["rejected"] = difference(samples, &W::num_rejected);
        world["capture_to_collision_ms"] = latency_json(samples, &W::capture_to_collision);
        add_process(
            world, samples, "run_ms_per_mesh", difference(samples, &W::num_meshes_received));
    }
    {
        using V = bus::ViewerStatus;
        const auto& samples = viewer_.samples;
        ordered_json& viewer = root["viewer"];
        viewer["frames_per_s"] = median(samples, &V::frames_per_s);
        // how far it reduced its quality (docs/viewer.md, Giving way)
        viewer["max_frames_per_s"] = median(samples, &V::max_frames_per_s);
        viewer["scale"] = median(samples, &V::scale);
        viewer["shadows"] = median(samples, [](const V& s) { return s.has_shadows ? 1.0 : 0.0; });
        viewer["video_dropped"] = difference(samples, &V::num_video_dropped);
        viewer["capture_to_display_ms"] = latency_json(samples, &V::capture_to_display);
        viewer["pairs_shown"] = difference(samples, &V::num_pairs_shown);
        viewer["pairs_skipped"] = difference(samples, &V::num_pairs_skipped);
        viewer["incomplete"] = difference(samples, &V::num_incomplete);
        viewer["rejected"] = difference(samples, &V::num_rejected);
        add_process(viewer, samples, "run_ms_per_picture", difference(samples, &V::num_frames));
    }
    return root.dump(2) + "\n";
}

}  // namespace atrium::demo
