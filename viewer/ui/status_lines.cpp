#include "viewer/ui/status_lines.hpp"

#include "core/app/log.hpp"
#include "core/status/bottleneck.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <utility>

namespace atrium::viewer {
namespace {

constexpr std::chrono::seconds kForgotten{4};
// A world server sends at least one state and one status a second.
constexpr std::chrono::milliseconds kWorldLost{1500};
constexpr std::chrono::seconds kWorldMissing{4};  // discovery over a network takes seconds

double seconds(StatusLines::Clock::duration duration) {
    return std::chrono::duration<double>(duration).count();
}
constexpr std::size_t kMaxPrograms = 128;  // 64 sites and 64 worlds

std::string with_p99(const status::Figures::Stage& stage) {
    const std::string text =
        fmt::format("{} {:.1f}", status::spaced(stage.name), stage.latency.median_ms);
    return stage.has_p99 ? fmt::format("{} (99 %: {:.1f})", text, stage.latency.p99_ms) : text;
}

}  // namespace

void StatusLines::add(const std::string& title, status::Figures figures, Clock::time_point now) {
    const auto found = programs_.find(title);
    if (found == programs_.end()) {
        if (programs_.size() < kMaxPrograms)
            programs_.emplace(title, Program{std::nullopt, std::move(figures), now});
        return;
    }
    Program& program = found->second;
    program.before.reset();
    // a restarted program counts from 0 again, so its losses are unknown
    if (may_be_same_process(program.now, figures)) program.before = std::move(program.now);
    program.now = std::move(figures);
    program.at = now;
}

void StatusLines::forget_silent(Clock::time_point now) {
    std::erase_if(programs_, [&](const auto& item) { return now - item.second.at > kForgotten; });
}

bool StatusLines::watch_world(Clock::time_point now,
                              const std::optional<Clock::time_point>& heard,
                              const std::optional<Clock::time_point>& lost) {
    if (heard && (!last_world_ || *heard > *last_world_)) last_world_ = heard;
    if (!watched_since_) watched_since_ = now;
    is_world_missing_ = !last_world_ && now - *watched_since_ > kWorldMissing;
    if (!last_world_) return false;
    const bool was_gone = without_world_ > Clock::duration::zero();
    const Clock::duration silence = now - *last_world_;
    const bool is_lost = lost && *lost > *last_world_ && silence > Clock::duration::zero();
    const bool is_gone = silence > kWorldLost || is_lost;
    if (was_gone && !is_gone) app::log::info("world_back after_s={:.1f}", seconds(without_world_));
    if (!was_gone && is_gone) app::log::warn("world_gone silent_s={:.1f}", seconds(silence));
    without_world_ = is_gone ? silence : Clock::duration::zero();
    return was_gone != is_gone;
}

std::vector<HudLine> StatusLines::warnings() const {
    std::vector<HudLine> lines;
    const auto& [heard, near] = other_worlds_;
    std::string meant;
    if (!near.empty())
        meant = fmt::format(". Did you mean {}?", fmt::join(near, ", "));
    else if (!heard.empty())
        meant = fmt::format(". Heard elsewhere: {}.", fmt::join(heard, ", "));
    if (!meant.empty()) meant += " Backspace: other worlds";
    if (is_world_missing_)
        lines.push_back({"no world server in this world: no objects" + meant, true});
    if (without_world_ > Clock::duration::zero()) {
        const double silent_s = seconds(without_world_);
        const std::string time = silent_s < 0.5 ? "" : fmt::format(" for {:.0f} s", silent_s);
        lines.push_back(
            {fmt::format("no world server{}: objects stand still or are gone{}", time, meant),
             true});
    }
    // they last, and lines below them come and go
    for (const auto& [title, program] : programs_) {
        for (const status::Figures::Alarm& alarm : program.now.alarms)
            lines.push_back({fmt::format("{}: {}: {}", title, alarm.what, alarm.advice), true});
    }
    for (const auto& [title, program] : programs_) {
        std::string lost;
        for (std::size_t i = 0; program.before && i < program.now.losses.size(); ++i) {
            const status::Counter& counter = program.now.losses[i];
            const std::uint64_t more = counter.total - program.before->losses[i].total;
            if (more == 0 || !counter.is_alarming) continue;
            lost += fmt::format(
                "{}{} {}", lost.empty() ? "" : ", ", status::spaced(counter.what), more);
        }
        const auto is_off = [](const auto& camera) { return !camera.status.connected; };
        const auto num_off = std::ranges::count_if(program.now.cameras, is_off);
        if (num_off > 0) lost += fmt::format("{}{} cameras off", lost.empty() ? "" : ", ", num_off);
        if (!lost.empty()) lines.push_back({title + ": " + lost, true});
        for (const status::Bottleneck& found : status::bottlenecks(program.before, program.now))
            lines.push_back({title + ": " + found.text, true});
    }
    return lines;
}

std::vector<HudLine> StatusLines::details() const {
    std::vector<HudLine> lines;
    for (const auto& [title, program] : programs_) {
        lines.push_back(
            {title + ": " + status::rate_text(program.now.rate, program.now.rate_unit), false});
        const std::vector<std::string> items = status::processor_items(program.now.processor);
        lines.push_back({fmt::format("  cpu  {}", fmt::join(items, "  ")), false});
        std::string stages;
        for (const status::Figures::Stage& stage : program.now.stages) {
            if (stage.latency.num_samples == 0) continue;
            // the total latency gets its own line
            if (stage.name.starts_with("capture_to_")) {
                if (!stages.empty()) lines.push_back({"  ms  " + std::exchange(stages, ""), false});
                lines.push_back({"  ms  " + with_p99(stage), false});
            } else {
                stages += (stages.empty() ? "" : "  ") + with_p99(stage);
            }
        }
        if (!stages.empty()) lines.push_back({"  ms  " + stages, false});
        const auto& rig = program.now.coherence;
        if (const auto of_rig = rig ? status::rig_items(*rig) : std::vector<std::string>();
            !of_rig.empty())
            lines.push_back({fmt::format("  rig  {}", fmt::join(of_rig, "  ")), false});
        for (const status::Figures::Alarm& alarm : program.now.alarms)
            lines.push_back({"  mend  " + alarm.cure, false});
    }
    return lines;
}

std::optional<double> StatusLines::rate_of_site(const std::string& site) const {
    const auto found = programs_.find("site " + site);
    if (found == programs_.end()) return std::nullopt;
    return found->second.now.rate;
}

std::uint64_t StatusLines::num_refused() const {
    std::uint64_t num = 0;
    for (const auto& [title, program] : programs_) {
        for (const status::Counter& counter : program.now.losses)
            if (counter.what == "refused_commands") num += counter.total;
    }
    return num;
}

}  // namespace atrium::viewer
