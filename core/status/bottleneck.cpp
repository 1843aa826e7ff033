#include "core/status/bottleneck.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <string_view>

namespace atrium::status {
namespace {

// A loss caused by a busy program, and the work that it is a share of. Names are those of
// figures.cpp.
struct Late {
    std::string_view lost;
    std::string_view done;
    bool done_includes_lost;
    const char* text;
};
constexpr std::array<Late, 3> kLate{{
    {"dropped_late", "metaframes_captured", true, "metaframes came too late for work"},
    {"dropped_late", "pictures", true, "pictures came too late for work"},
    {"skipped_ticks", "steps", false, "steps were skipped"},
}};

std::uint64_t total_of(const std::vector<Counter>& counters, std::string_view what) {
    const auto found = std::ranges::find(counters, what, &Counter::what);
    return found == counters.end() ? 0 : found->total;
}

// Increase of counters. `before` has the same counters, none of them larger.
struct Growth {
    const Figures& before;
    const Figures& now;

    std::uint64_t work(std::string_view what) const {
        return total_of(now.work, what) - total_of(before.work, what);
    }
    std::uint64_t losses(std::string_view what) const {
        return total_of(now.losses, what) - total_of(before.losses, what);
    }
};

bool is_much(std::uint64_t part, std::uint64_t whole) {
    return part > 1 && part <= whole &&
           static_cast<double>(part) >= kOverloaded * static_cast<double>(whole);
}

// "5 of 30 metaframes came too late for work"; empty if the loss is below kOverloaded.
std::string late_text(const Growth& growth) {
    for (const Late& late : kLate) {
        const std::uint64_t lost = growth.losses(late.lost);
        const std::uint64_t due = growth.work(late.done) + (late.done_includes_lost ? 0 : lost);
        if (is_much(lost, due)) return fmt::format("{} of {} {}", lost, due, late.text);
    }
    return {};
}

std::string network_text(const Growth& growth) {
    const std::uint64_t left_out = growth.losses("dropped_for_rate");
    if (const auto& stream = growth.now.stream; stream && left_out > 0) {
        const bool is_option = stream->cap_set_by.starts_with("stream.");
        return fmt::format("{}: {} of {} metaframes left out for {:.1f} Mbit/s",
                           is_option ? "limited by " + stream->cap_set_by
                                     : "network too slow to " + stream->cap_set_by,
                           left_out,
                           growth.work("metaframes_captured"),
                           stream->cap_bit_per_s / 1e6);
    }
    const std::uint64_t incomplete = growth.losses("incomplete_pairs");
    const std::uint64_t all = growth.work("pairs_shown") + incomplete;
    if (is_much(incomplete, all)) {
        return fmt::format(
            "network loses data: {} of {} pairs arrived incomplete", incomplete, all);
    }
    return {};
}

// Whether a host of regions was lost: the site waited for it, and work came late.
bool waited_for_host(const Growth& growth) {
    return std::ranges::any_of(growth.now.hosts, [&](const bus::HostStatus& host) {
        const auto before =
            std::ranges::find(growth.before.hosts, host.name, &bus::HostStatus::name);
        return host.num_regions > 0 && host.state != bus::HostState::kInUse &&
               before != growth.before.hosts.end() && before->state == bus::HostState::kInUse;
    });
}

std::string percent(double share) { return fmt::format("{:.0f} %", 100.0 * share); }

}  // namespace

bool is_short_of_processor(const ProcessorUse& use) {
    return use.is_waiting_known && use.longest_wait_per_s >= kShortOfProcessor;
}

std::vector<std::string> processor_items(const ProcessorUse& use) {
    const std::string waited = use.is_waiting_known ? fmt::format("waited {} (all threads {})",
                                                                  percent(use.longest_wait_per_s),
                                                                  percent(use.waited_per_s))
                                                    : "waited ?";
    return {fmt::format("{:.2f} cores", use.run_per_s), waited, fmt::format("nice {}", use.nice)};
}

std::string process_fields(const ProcessorUse& use, double first_output_s) {
    const std::string waited =
        use.is_waiting_known ? fmt::format("{:.1f}", 1e-9 * static_cast<double>(use.waited_ns))
                             : "unknown";
    return fmt::format("processor_s={:.1f} waited_s={} first_output_s={:.2f}",
                       1e-9 * static_cast<double>(use.run_ns),
                       waited,
                       first_output_s);
}

const char* name_of(Cause cause) {
    constexpr std::array kNames{"machine_too_slow",
                                "work_too_slow",
                                "machine_or_work_too_slow",
                                "network_too_slow",
                                "stood_still"};
    return kNames.at(static_cast<std::size_t>(cause));
}

std::vector<Bottleneck> bottlenecks(const std::optional<Figures>& before, const Figures& now) {
    std::vector<Bottleneck> found;
    const bool has_before = before && may_be_same_process(*before, now);
    const Growth growth{has_before ? *before : now, now};
    const std::string late = waited_for_host(growth) ? "" : late_text(growth);
    // a program that is not busy itself loses nothing to its own work: any wait held it up
    const bool is_held_up = !late.empty() && now.processor.is_waiting_known &&
                            now.processor.run_per_s < kBusyCores &&
                            now.processor.longest_wait_per_s >= kOverloaded;
    const bool is_short = is_short_of_processor(now.processor) || is_held_up;
    if (is_short || (!late.empty() && is_short_of_processor(before->processor))) {
        const ProcessorUse& use = is_short ? now.processor : before->processor;
        found.push_back(
            {Cause::kMachine,
             fmt::format("machine too slow: one thread waited {} of the time for a core{}",
                         percent(use.longest_wait_per_s),
                         late.empty() ? "" : "; " + late)});
        return found;
    }
    if (!late.empty() && now.processor.is_waiting_known && now.processor.run_per_s < kBusyCores) {
        found.push_back({Cause::kStoodStill,
                         fmt::format("the program stood still: {}; it used {:.2f} cores and waited "
                                     "{} of the time for one",
                                     late,
                                     now.processor.run_per_s,
                                     percent(now.processor.longest_wait_per_s))});
    } else if (!late.empty()) {
        const bool is_known = now.processor.is_waiting_known;
        found.push_back(
            {is_known ? Cause::kWork : Cause::kMachineOrWork,
             fmt::format("{}: {}",
                         is_known ? "work takes longer than its period, though cores are free"
                                  : "machine too slow or work too long",
                         late)});
    }
    if (std::string network = network_text(growth); !network.empty())
        found.push_back({Cause::kNetwork, std::move(network)});
    return found;
}

std::string advice(Cause cause, bus::ProgramKind kind, double share_of_host) {
    if (cause == Cause::kNetwork) return "see docs/streams.md";
    if (cause == Cause::kStoodStill)
        return "check whether the program was stopped (Ctrl-Z, a debugger), the host slept, or its "
               "virtual machine got no processor time (st in top)";
    if (cause == Cause::kMachine && share_of_host < kLargestUser)
        return "other programs use most of this host's cores: see top, and end some of them or "
               "give them a lower priority (nice)";
    std::string less = "give it less to do";
    if (kind == bus::ProgramKind::kSiteNode || kind == bus::ProgramKind::kCameraNode)
        less = "lower capture.rate_hz, or use fewer or smaller pictures";
    if (kind == bus::ProgramKind::kRegionNode)
        less = "lower capture.rate_hz, or give regions to more hosts";
    if (kind == bus::ProgramKind::kWorldServer) less = "lower world.tick_hz, or use fewer objects";
    if (kind == bus::ProgramKind::kViewer)
        less = "make the picture smaller (view.width, view.height), or lower view.max_fps";
    if (cause == Cause::kWork &&
        (kind == bus::ProgramKind::kSiteNode || kind == bus::ProgramKind::kCameraNode ||
         kind == bus::ProgramKind::kRegionNode))
        return less + " or more site.threads";
    return cause == Cause::kWork ? less : "run fewer programs on this host, " + less;
}

std::optional<std::string> OverloadLog::look(Figures now, Clock::time_point time) {
    const std::vector<Bottleneck> found = bottlenecks(before_, now);
    const ProcessorUse use = now.processor;
    before_ = std::move(now);
    if (found.empty() || found.front().cause == Cause::kNetwork) return std::nullopt;
    const Cause cause = found.front().cause;
    Repeat& repeat = repeats_[cause];
    if (time - repeat.last_seen > repeat.period) repeat = {};
    repeat.last_seen = time;
    if (time < repeat.due) return std::nullopt;
    repeat.due = time + repeat.period;
    repeat.period = std::min(2 * repeat.period, kLongestPeriod);
    std::string what_to_do = own_advice_ ? own_advice_(cause) : "";
    if (what_to_do.empty()) what_to_do = advice(cause, kind_, use.run_per_s / host_cores_);
    return fmt::format("{} reason=\"{}\" cores={:.2f} host_cores={} advice=\"{}\"",
                       name_of(cause),
                       found.front().text,
                       use.run_per_s,
                       host_cores_,
                       what_to_do);
}

}  // namespace atrium::status
