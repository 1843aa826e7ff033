#pragma once

#include "core/app/log.hpp"
#include "core/base/statistics.hpp"
#include "core/bus/messages.hpp"
#include "world_server/command_inbox.hpp"
#include "world_server/config.hpp"
#include "world_server/outbox.hpp"
#include "world_server/people_inbox.hpp"
#include "world_server/scene.hpp"
#include "world_server/state_saver.hpp"

#include <atomic>
#include <functional>
#include <mutex>
#include <stop_token>
#include <string>
#include <vector>

namespace atrium::world_server {

inline bus::LatencySummary to_summary(const Quantiles& quantiles) {
    return {quantiles.median_ms, quantiles.p99_ms, quantiles.num_samples};
}

/// The world in real time: takes people and commands from their inboxes before each tick, and puts
/// what came of it into the outbox. Of one thread, but for `want_people` and `fill`.
class Simulation {
public:
    /// `reject` is told why a command was refused, by the simulating thread.
    Simulation(const WorldServerConfig& config,
               Scene scene,
               std::function<void(const std::string& why)> reject);

    PeopleInbox& people() { return people_; }
    CommandInbox& commands() { return commands_; }
    Outbox& outbox() { return outbox_; }
    StateSaver& saver() { return saver_; }

    /// Whether somebody wants to know what people are to the physics; then it puts that into the
    /// outbox ten times a second. Thread-safe.
    void want_people(bool is_wanted) { wants_people_ = is_wanted; }

    /// Until a stop is requested or `config.seconds` have passed.
    void run(std::stop_token stop);
    /// One tick with all that belongs to it, for who keeps the time himself: `due` is when it was.
    /// Allocates nothing as long as no object comes or goes and nothing is saved.
    void step(Timestamp due);
    /// The state as it is now, to the file, if there is one.
    Expected<void> save_last();
    /// The figures that it knows, as of now. Thread-safe.
    void fill(bus::WorldStatus& status) const;

private:
    void apply_commands();
    void apply(const bus::SceneCommand& command);
    void refuse(const bus::SceneCommand& command, const std::string& why);
    void apply_people();
    void save();
    void restore();
    double credit_of_tick() const { return config_.send_hz / config_.tick_hz; }
    void send_state(Timestamp due);
    void send_people();
    void look_after();
    void hash_now_and_then(double tick_s);

    const WorldServerConfig config_;
    Scene scene_;
    std::function<void(const std::string& why)> reject_;
    PeopleInbox people_;
    CommandInbox commands_;
    Outbox outbox_;
    StateSaver saver_;
    bool was_touched_ = false;    // somebody touched something in the last tick
    double send_credit_ = 0.0;    // states that should have been sent by now,
    double save_credit_s_ = 0.0;  // and simulated time since the last save,
    double hash_credit_s_ = 0.0;  // and the last hash
    double people_credit_ = 0.0;  // people that should have been sent by now
    std::atomic<bool> wants_people_ = false;
    MovedState moved_;  // scratch, as are the next two
    std::vector<physics::PersonNow> people_now_;
    std::vector<physics::Incident> incidents_;
    app::log::OncePerSecond incidents_log_;
    app::log::OncePerSecond commands_log_;  // what came and went by them

    mutable std::mutex status_mutex_;  // guards the rest
    bus::WorldStatus figures_;         // those that no other member has
    LatencyWindow capture_to_collision_;
    LatencyWindow step_times_;
};

}  // namespace atrium::world_server
