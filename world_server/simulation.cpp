#include "world_server/simulation.hpp"

#include "world_server/pace.hpp"
#include "world_server/scene_messages.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <map>
#include <string>
#include <utility>

namespace atrium::world_server {
namespace {

using Clock = Pace::Clock;
constexpr int kMaxCatchUpTicks = 4;  // at 120 Hz, the allowed delay is one mesh period
constexpr double kHashPeriodS = 10.0;
constexpr double kPeopleHz = 10.0;  // enough for a debug view
constexpr double kRounding = 1e-9;  // rounding of a sum of shares

}  // namespace

Simulation::Simulation(const WorldServerConfig& config,
                       Scene scene,
                       std::function<void(const std::string& why)> reject)
    : config_(config),
      scene_(std::move(scene)),
      reject_(std::move(reject)),
      commands_(config.rights),
      saver_(config.state_file) {
    for (const SceneChange& change : scene_.all()) outbox_.put(change);
    for (const WorldScenery& scenery : scene_.description().scenery)
        outbox_.put(to_message(scenery));
}

void Simulation::refuse(const bus::SceneCommand& command, const std::string& why) {
    {
        const std::lock_guard lock(status_mutex_);
        ++figures_.num_refused;
    }
    reject_("command of " + command.sender + ": " + why);
    if (auto answer =
            answers_.refused(command.sender, command.kind, command.target, why, answer_time()))
        outbox_.put(std::move(*answer));
}

CommandAnswers::Clock::time_point Simulation::answer_time() const {
    if (!recorded_now_) return CommandAnswers::Clock::now();
    return CommandAnswers::Clock::time_point(std::chrono::nanoseconds(recorded_now_->ns));
}

void Simulation::apply(const bus::SceneCommand& command) {
    const bool is_of_file =
        command.kind == bus::CommandKind::kSave || command.kind == bus::CommandKind::kRestore;
    if (is_of_file && !saver_.is_on()) {
        return refuse(command,
                      fmt::format("{}: the world has no state file", to_string(command.kind)));
    }
    if (command.kind == bus::CommandKind::kSave) return save();
    if (command.kind == bus::CommandKind::kRestore) return restore();
    const auto changes = scene_.apply(command);
    if (!changes) return refuse(command, changes.error().message);
    for (const SceneChange& change : *changes) outbox_.put(change);
    if (auto answer = answers_.done(command.sender, command.kind, answer_time()))
        outbox_.put(std::move(*answer));
    if (command.kind == bus::CommandKind::kReset || !changes->empty())
        commands_log_.info(fmt::format("{} by={}", to_string(command.kind), command.sender));
}

void Simulation::apply_commands() {
    const CommandInbox::Content waiting = commands_.take_all();
    for (const bus::SceneCommand& command : waiting.commands) apply(command);
    for (const PreparedEdit& prepared : waiting.edits) apply(prepared);
    for (const std::string& sender : waiting.left) scene_.forget_sender(sender);
}

void Simulation::save() {
    save_credit_s_ = 0.0;
    SavedWorld saved;
    scene_.save(saved);
    saver_.put(std::move(saved));
}

// Runs on the simulating thread, which waits for the disk: the world must not change meanwhile.
// People return with their next mesh.
void Simulation::restore() {
    auto restored = load_scene(config_);
    if (!restored) return app::log::error("restore_failed {}", restored.error().message);
    if (!*restored) return app::log::warn("restore_failed nothing was saved yet");
    replace_scene(std::move(**restored));
    app::log::info("state_restored tick={}", scene_.world().counters().num_ticks);
}

void Simulation::replace_scene(Scene scene) {
    const auto scenery_of = [](const Scene& of) {
        std::vector<bus::Scenery> messages;
        for (const WorldScenery& scenery : of.description().scenery)
            messages.push_back(to_message(scenery));
        return messages;
    };
    for (SceneChange& change : scene_.all()) {
        change.is_gone = true;
        outbox_.put(change);
    }
    outbox_.replace(scenery_of(scene_), scenery_of(scene));
    scene_ = std::move(scene);
    for (const SceneChange& change : scene_.all()) outbox_.put(change);
}

void Simulation::refuse(const bus::SceneEdit& edit, const std::string& why) {
    {
        const std::lock_guard lock(status_mutex_);
        ++figures_.num_refused;
    }
    reject_("edit of " + edit.sender + ": " + why);
    outbox_.put(result_of(edit, false, why));
}

void Simulation::save_world(const bus::SceneEdit& edit) {
    const SavedWorldsFolder& folder = edit_worker_.folder();
    std::string text;
    if (folder.is_on()) text = world_text(config_, scene_, folder.folder());
    // without a folder the worker refuses it
    if (!edit_worker_.save(edit, std::move(text))) refuse(edit, "too many worlds to save at once");
}

void Simulation::load_world(const PreparedEdit& prepared) {
    auto scene = Scene::create(*prepared.world);
    if (!scene) return refuse(prepared.edit, scene.error().message);
    replace_scene(std::move(*scene));
    app::log::info("world_loaded name={} by={}", prepared.edit.world_file, prepared.edit.sender);
    outbox_.put(result_of(prepared.edit, true, {}));
}

void Simulation::apply(const PreparedEdit& prepared) {
    const bus::SceneEdit& edit = prepared.edit;
    if (edit.kind == bus::EditKind::kSaveWorld) return save_world(edit);
    if (edit.kind == bus::EditKind::kLoadWorld) return load_world(prepared);
    const auto outcome = scene_.edit(edit, prepared.parts);
    if (!outcome) return refuse(edit, outcome.error().message);
    for (const SceneChange& change : outcome->changes) outbox_.put(change);
    if (edit.kind == bus::EditKind::kHold) return;
    bus::EditResult result = result_of(edit, true, outcome->text);
    result.object = outcome->object;
    result.revision = outcome->revision;
    outbox_.put(result);
    commands_log_.info(
        fmt::format("{} object={} by={}", to_string(edit.kind), outcome->object, edit.sender));
}

void Simulation::apply_people() {
    people_.take_all([&](const std::string& site, std::optional<physics::PersonShape>&& shape) {
        if (!shape) return scene_.world().remove_person(site);
        scene_.world().set_person(site, *shape);
        const std::lock_guard lock(status_mutex_);
        capture_to_collision_.add(now() - shape->delays_from);
    });
}

void Simulation::send_state(Timestamp due) {
    send_credit_ += credit_of_tick();
    if (send_credit_ < 1.0 - kRounding) return;
    send_credit_ -= 1.0;
    scene_.get_state(config_.bus.world, due, moved_.rigid);
    scene_.get_soft_states(due, moved_.soft);
    outbox_.put(moved_);
}

// Surfels are shared, not copied, which costs a tick almost nothing.
void Simulation::send_people() {
    if (!wants_people_) return;
    people_credit_ += kPeopleHz / config_.tick_hz;
    if (people_credit_ < 1.0 - kRounding) return;
    people_credit_ = 0.0;
    scene_.world().get_people(people_snapshots_);
    outbox_.put(people_snapshots_);
}

void Simulation::hash_periodically(double tick_s) {
    hash_credit_s_ += tick_s;
    if (hash_credit_s_ < kHashPeriodS) return;
    hash_credit_s_ = 0.0;
    const std::uint64_t tick = scene_.world().counters().num_ticks;
    const std::uint64_t hash = scene_.world().state_hash();
    app::log::debug("state_hash tick={} hash={:016x}", tick, hash);
    const std::lock_guard lock(status_mutex_);
    figures_.state_tick = tick;
    figures_.state_hash = hash;
}

// Reports incidents, computes the hash and saves, each at its period.
void Simulation::report_and_save() {
    const double tick_s = 1.0 / config_.tick_hz;
    std::map<std::uint32_t, std::string> names;  // names of removed objects
    for (const SceneChange& change : scene_.take_removed(incidents_)) {
        names[change.object.object] = change.object.name;
        outbox_.put(change);
    }
    for (const physics::Incident& incident : incidents_) {
        const auto gone = names.find(incident.object);
        incidents_log_.warn(
            fmt::format("object {} ({}) {}",
                        incident.object,
                        gone == names.end() ? scene_.name_of(incident.object) : gone->second,
                        physics::describe(incident.kind)));
    }
    hash_periodically(tick_s);
    save_credit_s_ += tick_s;
    if (saver_.is_on() && config_.save_every_s > 0.0 && save_credit_s_ >= config_.save_every_s)
        save();
    const std::lock_guard lock(status_mutex_);
    if (!incidents_.empty()) {
        figures_.num_resets += incidents_.size();
        figures_.last_reset = incidents_.back().object;
    }
    figures_.num_objects = scene_.num_objects();
    figures_.num_grabs = scene_.world().num_grabs();
}

void Simulation::step(Timestamp due) {
    const Clock::time_point begin = Clock::now();
    apply_commands();
    apply_people();
    const std::uint64_t num_contacts = scene_.world().counters().num_contact_ticks;
    scene_.world().tick();
    const bool is_touched = scene_.world().counters().num_contact_ticks > num_contacts;
    // a touch has begun: send this tick's state at once
    if (is_touched && !was_touched_) send_credit_ = std::max(send_credit_, 1.0 - credit_of_tick());
    was_touched_ = is_touched;
    send_state(due);
    send_people();
    report_and_save();
    const std::lock_guard lock(status_mutex_);
    // not those of the world, which go back when another world is loaded or a state is restored
    ++figures_.num_steps;
    if (is_touched) ++figures_.num_contacts;
    step_times_.add(Clock::now() - begin);
}

void Simulation::step_recorded(Timestamp due) {
    recorded_now_ = due;
    step(due);
}

void Simulation::run(std::stop_token stop) {
    const std::chrono::nanoseconds tick(static_cast<std::int64_t>(1e9 / config_.tick_hz));
    const Clock::time_point start = Clock::now();
    Pace pace(tick, kMaxCatchUpTicks, start);
    while (!stop.stop_requested()) {
        sleep_until(pace.next(), stop);
        const Clock::time_point now = Clock::now();
        for (int i = pace.num_due(now); i > 0 && !stop.stop_requested(); --i) {
            // scheduled time on the clock of the state's time stamps
            const std::chrono::nanoseconds ahead = pace.next() - i * tick - Clock::now();
            step(Timestamp::now() + ahead);
        }
        {
            const std::lock_guard lock(status_mutex_);
            figures_.num_skipped_ticks = pace.num_skipped();
        }
        const double seconds = std::chrono::duration<double>(now - start).count();
        if (config_.seconds > 0.0 && seconds >= config_.seconds) return;
    }
}

Expected<void> Simulation::save_last() {
    if (!saver_.is_on()) return {};
    SavedWorld last;
    scene_.save(last);
    return saver_.save(last);
}

void Simulation::fill(bus::WorldStatus& status) const {
    const std::lock_guard lock(status_mutex_);
    status = figures_;
    status.num_saves = saver_.num_saves();
    status.capture_to_collision = to_summary(capture_to_collision_.quantiles());
    status.step = to_summary(step_times_.quantiles());
}

}  // namespace atrium::world_server
