#include "tools/monitor/world_model.hpp"

#include "core/bus/names.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace atrium::monitor {
namespace {

// A site has two topics and a world server one; more would be an error here.
constexpr std::size_t kMaxMeasuredTopics = 4;
// A status may arrive just after the end of its writer was reported.
constexpr std::chrono::seconds kLateStatus{3};

}  // namespace

WorldModel::Program* WorldModel::row(const ProgramKey& key) {
    const auto found = programs_.find(key);
    if (found != programs_.end()) return &found->second;
    if (programs_.size() >= kMaxPrograms) {
        // replace a program that left
        const auto gone = std::find_if(programs_.begin(), programs_.end(), [](const auto& entry) {
            return entry.second.gone_at.has_value();
        });
        if (gone == programs_.end()) {
            ++num_left_out_;
            return nullptr;
        }
        programs_.erase(gone);
    }
    return &programs_[key];
}

// Returns the process that holds the name. Of several equal claims, the earliest start wins.
const bus::Presence* WorldModel::holder(const Program& program) {
    const bus::Presence* best = nullptr;
    for (const auto& [instance, presence] : program.instances) {
        const bool is_better =
            best == nullptr || presence.is_holder > best->is_holder ||
            (presence.is_holder == best->is_holder && presence.start_time < best->start_time);
        if (is_better) best = &presence;
    }
    return best;
}

void WorldModel::see(const bus::Presence& presence, Clock::time_point now) {
    Program* program = row({presence.kind, presence.name});
    if (program == nullptr) return;
    if (program->instances.size() >= kMaxInstances &&
        !program->instances.contains(presence.instance)) {
        ++num_left_out_;
        return;
    }
    program->instances[presence.instance] = presence;
    program->gone_at.reset();
    program->seen_at = now;
    const bus::Presence* has_name = holder(*program);
    if (program->instance && *program->instance != has_name->instance) {
        // another process: the former counters do not belong to it
        program->figures.reset();
        program->before.reset();
    }
    program->instance = has_name->instance;
    program->last_presence = *has_name;
}

void WorldModel::leave(Program& program, bus::Ending how, Clock::time_point now) {
    if (program.gone_at) return;
    program.gone_at = now;
    program.gone_reason = how == bus::Ending::kDisposed
                              ? "it ended"
                              : "lost without a word: killed, or cut off from the network";
}

void WorldModel::gone(const bus::Presence& key, bus::Ending how, Clock::time_point now) {
    const auto found = programs_.find({key.kind, key.name});
    if (found == programs_.end()) return;
    Program& program = found->second;
    if (program.instances.erase(key.instance) == 0) return;
    if (program.instances.empty()) return leave(program, how, now);
    const bus::Presence* has_name = holder(program);
    if (program.instance != has_name->instance) {
        program.figures.reset();
        program.before.reset();
        program.instance = has_name->instance;
    }
    program.last_presence = *has_name;
}

void WorldModel::take(const ProgramKey& key, Figures figures, Clock::time_point now) {
    Program* program = row(key);
    if (program == nullptr) return;
    if (program->gone_at) {
        if (now - *program->gone_at < kLateStatus) return;
        *program = {};
    }
    const bool is_same = program->figures && may_be_same_process(*program->figures, figures);
    if (is_same)
        program->before = std::move(program->figures);
    else
        program->before.reset();
    program->figures = std::move(figures);
    program->figures_at = program->seen_at = now;
}

void WorldModel::see(const bus::SiteStatus& status, Clock::time_point now) {
    take({bus::ProgramKind::kSiteNode, status.site}, figures_of(status), now);
}

void WorldModel::see(const bus::WorldStatus& status, Clock::time_point now) {
    take({bus::ProgramKind::kWorldServer, status.world}, figures_of(status), now);
}

void WorldModel::see(const bus::ViewerStatus& status, Clock::time_point now) {
    take({bus::ProgramKind::kViewer, status.viewer}, figures_of(status), now);
}

void WorldModel::see(const bus::CameraNodeStatus& status, Clock::time_point now) {
    take({bus::ProgramKind::kCameraNode, bus::host_program_name(status.site, status.host)},
         figures_of(status),
         now);
}

void WorldModel::see(const bus::RegionNodeStatus& status, Clock::time_point now) {
    take({bus::ProgramKind::kRegionNode, bus::host_program_name(status.site, status.host)},
         figures_of(status),
         now);
}

void WorldModel::status_gone(bus::ProgramKind kind,
                             const std::string& name,
                             bus::Ending how,
                             Clock::time_point now) {
    const auto found = programs_.find({kind, name});
    if (found != programs_.end() && found->second.instances.empty()) leave(found->second, how, now);
}

void WorldModel::note_samples(Stream& stream,
                              const char* what,
                              std::uint64_t amount,
                              Clock::time_point now) {
    auto& [total, window] = stream.counts[what];
    total += amount;
    window.add(static_cast<double>(amount), now);
}

void WorldModel::see(const bus::StreamFeedback& feedback, Clock::time_point now) {
    const auto key = std::make_pair(feedback.viewer, feedback.site);
    if (streams_.size() >= kMaxStreams && !streams_.contains(key)) {
        ++num_left_out_;
        return;
    }
    Stream& stream = streams_[key];
    stream.newest = feedback;
    stream.seen_at = now;
    note_samples(stream, "complete", feedback.num_complete, now);
    note_samples(stream, "incomplete_pairs", feedback.num_incomplete, now);
    note_samples(stream, "late_samples", feedback.num_late, now);
}

void WorldModel::gone(const bus::StreamFeedback& key) { streams_.erase({key.viewer, key.site}); }

void WorldModel::measured(const std::string& topic,
                          bus::ProgramKind kind,
                          const std::string& writer,
                          std::size_t payload_bytes,
                          Clock::time_point now) {
    // measurements alone do not add a program
    const auto found = programs_.find({kind, writer});
    if (found == programs_.end() || found->second.gone_at) return;
    auto& topics = found->second.measured;
    if (topics.size() >= kMaxMeasuredTopics && !topics.contains(topic)) return;
    Measured& counts = topics[topic];
    counts.bytes.add(static_cast<double>(payload_bytes), now);
    counts.samples.add(1.0, now);
}

void WorldModel::rejected(const bus::TakeReport& report, Clock::time_point now) {
    if (report.num_rejected == 0) return;
    notice("rejected samples: " + report.first_rejection, now);
}

void WorldModel::notice(const std::string& line, Clock::time_point now) {
    const auto same = std::find_if(
        notices_.begin(), notices_.end(), [&](const auto& entry) { return entry.second == line; });
    if (same != notices_.end()) notices_.erase(same);
    notices_.emplace_back(now, line.substr(0, 400));
    if (notices_.size() > kMaxNotices) notices_.pop_front();
}

void WorldModel::forget_the_gone(Clock::time_point now) {
    std::erase_if(programs_, [&](const auto& entry) {
        const Program& program = entry.second;
        if (program.gone_at) return now - *program.gone_at >= kShowGone;
        // a silent program without a Presence counts as gone
        return program.instances.empty() && now - program.seen_at >= kShowGone;
    });
    std::erase_if(streams_,
                  [&](const auto& entry) { return now - entry.second.seen_at >= kShowGone; });
    while (!notices_.empty() && now - notices_.front().first >= kKeepNotice) notices_.pop_front();
}

}  // namespace atrium::monitor
