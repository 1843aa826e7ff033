#pragma once

#include "core/app/log.hpp"
#include "core/base/statistics.hpp"
#include "core/bus/messages.hpp"
#include "world_server/command_answers.hpp"
#include "world_server/command_inbox.hpp"
#include "world_server/config.hpp"
#include "world_server/edit_worker.hpp"
#include "world_server/outbox.hpp"
#include "world_server/people_inbox.hpp"
#include "world_server/scene.hpp"
#include "world_server/state_saver.hpp"

#include <atomic>
#include <functional>
#include <mutex>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

namespace atrium::world_server {

inline bus::LatencySummary to_summary(const Quantiles& quantiles) {
    return {quantiles.median_ms, quantiles.p99_ms, quantiles.num_samples};
}

/// Runs the world in real time. Before each tick it takes people and commands from their inboxes.
/// After each tick it puts the results into the outbox. Used by one thread only, except for
/// `want_people` and `fill`.
class Simulation {
public:
    /// The simulating thread calls `reject` with the reason when it refuses a command.
    Simulation(const WorldServerConfig& config,
               Scene scene,
               std::function<void(const std::string& why)> reject);

    PeopleInbox& people() { return people_; }
    CommandInbox& commands() { return commands_; }
    CommandAnswers& answers() { return answers_; }
    Outbox& outbox() { return outbox_; }
    StateSaver& saver() { return saver_; }
    EditWorker& edit_worker() { return edit_worker_; }

    /// Enables person proxies: the collision shapes of people go to the outbox ten times a second.
    /// Thread-safe.
    void want_people(bool is_wanted) { wants_people_ = is_wanted; }

    /// Runs until a stop is requested or `config.seconds` have passed.
    void run(std::stop_token stop);
    /// Runs one complete step without pacing; `due` is its scheduled time. Allocates nothing as
    /// long as no object is added or removed and nothing is saved.
    void step(Timestamp due);
    /// Like `step`, at a time of the past: nothing depends on this machine's clock.
    void step_recorded(Timestamp due);
    /// Of the world now (physics::World::state_hash).
    std::uint64_t state_hash() const { return scene_.world().state_hash(); }
    /// Saves the current state to the state file, if there is one.
    Expected<void> save_last();
    /// Fills in the status fields known here. Thread-safe.
    void fill(bus::WorldStatus& status) const;

private:
    void apply_commands();
    void apply(const bus::SceneCommand& command);
    void refuse(const bus::SceneCommand& command, const std::string& why);
    void apply(const PreparedEdit& prepared);
    void refuse(const bus::SceneEdit& edit, const std::string& why);
    void save_world(const bus::SceneEdit& edit);
    void load_world(const PreparedEdit& prepared);
    void replace_scene(Scene scene);
    void apply_people();
    void save();
    void restore();
    Timestamp now() const { return recorded_now_ ? *recorded_now_ : Timestamp::now(); }
    CommandAnswers::Clock::time_point answer_time() const;
    double credit_of_tick() const { return config_.send_hz / config_.tick_hz; }
    void send_state(Timestamp due);
    void send_people();
    void report_and_save();
    void hash_periodically(double tick_s);

    const WorldServerConfig config_;
    Scene scene_;
    std::function<void(const std::string& why)> reject_;
    PeopleInbox people_;
    CommandInbox commands_;
    CommandAnswers answers_;
    Outbox outbox_;
    StateSaver saver_;
    EditWorker edit_worker_{config_, commands_, outbox_};
    bool was_touched_ = false;    // a person touched an object in the last tick
    double send_credit_ = 0.0;    // states due but not yet sent
    double save_credit_s_ = 0.0;  // simulated time since the last save
    double hash_credit_s_ = 0.0;  // simulated time since the last hash
    double people_credit_ = 0.0;  // person messages due but not yet sent
    std::atomic<bool> wants_people_ = false;
    std::optional<Timestamp> recorded_now_;  // nullopt: the simulation is live
    MovedState moved_;                       // scratch, like the next two
    std::vector<physics::PersonSnapshot> people_snapshots_;
    std::vector<physics::Incident> incidents_;
    app::log::OncePerSecond incidents_log_;
    app::log::OncePerSecond commands_log_;  // additions and removals by commands

    mutable std::mutex status_mutex_;  // guards the members below
    bus::WorldStatus figures_;         // the fields without another source
    LatencyWindow capture_to_collision_;
    LatencyWindow step_times_;
};

}  // namespace atrium::world_server
