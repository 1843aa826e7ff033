#include "world_server/world_server.hpp"

#include "core/app/log.hpp"
#include "core/app/program.hpp"
#include "core/base/statistics.hpp"
#include "core/joining/join_world.hpp"
#include "world_server/command_inbox.hpp"
#include "world_server/endpoints.hpp"
#include "world_server/outbox.hpp"
#include "world_server/pace.hpp"
#include "world_server/people_inbox.hpp"
#include "world_server/publisher.hpp"
#include "world_server/scene.hpp"
#include "world_server/site_register.hpp"
#include "world_server/state_saver.hpp"

#include <fmt/format.h>

#include <atomic>
#include <chrono>
#include <mutex>
#include <set>
#include <thread>

namespace atrium::world_server {
namespace {

using Clock = Pace::Clock;
constexpr int kMaxCatchUpTicks = 4;  // what a tick of 120 Hz may be late by is one mesh period
constexpr double kHashPeriodS = 10.0;
constexpr std::chrono::milliseconds kStatusPeriod{1000};

bus::LatencySummary to_summary(const Quantiles& quantiles) {
    return {quantiles.median_ms, quantiles.p99_ms, quantiles.num_samples};
}

}  // namespace

struct WorldServer::Impl {
    Impl(const WorldServerConfig& server_config, Endpoints server_endpoints, Scene server_scene);

    // the receiving thread
    void receive(std::stop_token stop);
    void take_descriptions();
    void take_meshes();
    void take_commands();
    bool arrive(const std::string& site);
    void leave(const std::string& site);
    void count_rejected(const bus::TakeReport& report);
    void reject(const std::string& why);

    // the simulating thread
    void simulate(std::stop_token stop);
    void step(Timestamp due);
    void apply_commands();
    void apply(const bus::SceneCommand& command);
    void refuse(const bus::SceneCommand& command, const std::string& why);
    void apply_people();
    void save();
    void restore();
    void send_state(Timestamp due);
    void look_after();

    // the publishing thread
    void publish(std::stop_token stop);

    bus::WorldStatus status() const;

    const WorldServerConfig config;
    Endpoints endpoints;
    Scene scene;         // of the simulating thread
    SiteRegister sites;  // of the receiving thread, as is the next one
    std::set<std::string> described_sites;
    PeopleInbox people;
    CommandInbox commands;
    Outbox outbox;
    Publisher publisher{endpoints};
    StateSaver saver;
    double send_credit = 0.0;                  // states that should have been sent by now,
    double save_credit_s = 0.0;                // and simulated time since the last save,
    double hash_credit_s = 0.0;                // and the last hash
    std::vector<physics::Incident> incidents;  // scratch
    app::log::OncePerSecond rejections_log;
    app::log::OncePerSecond incidents_log;

    std::atomic<std::uint64_t> num_meshes{0};
    std::atomic<std::uint64_t> num_rejected{0};
    std::atomic<std::uint64_t> num_refused{0};
    std::atomic<std::uint64_t> num_sites{0};
    std::atomic<std::uint64_t> num_skipped_ticks{0};
    mutable std::mutex status_mutex;  // guards the rest
    physics::WorldCounters counters;
    LatencyWindow capture_to_collision;
    LatencyWindow step_times;
    bus::WorldStatus figures;  // those that no other member has

    std::mutex lost_mutex;  // guards the next one
    std::optional<Error> lost;
    std::stop_source end;
    std::unique_ptr<bus::Membership> membership;  // goes first: its thread uses the rest
};

WorldServer::Impl::Impl(const WorldServerConfig& server_config,
                        Endpoints server_endpoints,
                        Scene server_scene)
    : config(server_config),
      endpoints(std::move(server_endpoints)),
      scene(std::move(server_scene)),
      sites(config.placements, static_cast<std::size_t>(config.max_sites), config.person),
      commands(config.rights),
      saver(config.state_file) {
    for (const SceneChange& change : scene.all()) outbox.put(change);
    for (const NamedPlacement& placement : config.placements) {
        outbox.put(bus::SitePlacement{placement.site, placement.world_from_site});
    }
}

void WorldServer::Impl::reject(const std::string& why) {
    ++num_rejected;
    rejections_log.warn("rejected " + why);
}

void WorldServer::Impl::count_rejected(const bus::TakeReport& report) {
    if (report.num_rejected == 0) return;
    num_rejected += report.num_rejected;
    rejections_log.warn("rejected " + report.first_rejection);
}

bool WorldServer::Impl::arrive(const std::string& site) {
    const auto placement = sites.arrive(site);
    if (!placement) {
        reject(placement.error().message);
        return false;
    }
    if (*placement) {
        const Eigen::Vector3d& position = (*placement)->world_from_site.translation;
        app::log::info("site_arrived site={} position_m={:.2f},{:.2f},{:.2f}",
                       site,
                       position.x(),
                       position.y(),
                       position.z());
        outbox.put(**placement);
    }
    num_sites = sites.num_present();
    return true;
}

void WorldServer::Impl::leave(const std::string& site) {
    sites.leave(site);
    people.put(site, std::nullopt);
    num_sites = sites.num_present();
    app::log::info("site_left site={}", site);
}

void WorldServer::Impl::take_descriptions() {
    count_rejected(endpoints.descriptions.take(
        [&](bus::SiteDescription&& description) {
            if (arrive(description.site)) described_sites.insert(description.site);
        },
        [&](const bus::SiteDescription& gone) {
            if (described_sites.erase(gone.site) > 0) leave(gone.site);
        }));
}

// Of each site the newest: several come at once where one of them had to be sent again.
void WorldServer::Impl::take_meshes() {
    std::map<std::string, bus::SiteMesh> newest;
    count_rejected(endpoints.meshes.take(
        [&](bus::SiteMesh&& message) {
            ++num_meshes;
            const std::string site = message.site;
            newest.insert_or_assign(site, std::move(message));
        },
        [&](const bus::SiteMesh& gone) {
            newest.erase(gone.site);
            if (!described_sites.contains(gone.site)) return leave(gone.site);
            sites.lose_mesh(gone.site);
            people.put(gone.site, std::nullopt);
        }));
    for (const auto& [site, message] : newest) {
        if (!arrive(site)) continue;
        auto shape = sites.read_mesh(message);
        if (shape)
            people.put(site, std::move(*shape));
        else
            reject(shape.error().message);
    }
}

void WorldServer::Impl::take_commands() {
    const Clock::time_point now = Clock::now();
    count_rejected(endpoints.commands.take(
        [&](bus::SceneCommand&& command) {
            const std::string sender = command.sender;
            if (const auto why = commands.put(std::move(command), now)) {
                ++num_refused;
                reject("command of " + sender + ": " + *why);
            }
        },
        [&](const bus::SceneCommand& gone) { commands.leave(gone.sender); }));
}

void WorldServer::Impl::receive(std::stop_token stop) {
    const std::stop_callback wake(stop, [this] { endpoints.waiter.wake(); });
    while (!stop.stop_requested()) {
        if (!endpoints.waiter.wait(std::chrono::milliseconds(500))) continue;
        take_descriptions();
        take_meshes();
        take_commands();
    }
}

void WorldServer::Impl::refuse(const bus::SceneCommand& command, const std::string& why) {
    ++num_refused;
    reject("command of " + command.sender + ": " + why);
}

void WorldServer::Impl::apply(const bus::SceneCommand& command) {
    const bool is_of_file =
        command.kind == bus::CommandKind::kSave || command.kind == bus::CommandKind::kRestore;
    if (is_of_file && !saver.is_on()) {
        return refuse(command, fmt::format("{}: the world has no file", to_string(command.kind)));
    }
    if (command.kind == bus::CommandKind::kSave) return save();
    if (command.kind == bus::CommandKind::kRestore) return restore();
    const auto changes = scene.apply(command);
    if (!changes) return refuse(command, changes.error().message);
    for (const SceneChange& change : *changes) outbox.put(change);
}

void WorldServer::Impl::apply_commands() {
    const CommandInbox::Content waiting = commands.take_all();
    for (const bus::SceneCommand& command : waiting.commands) apply(command);
    for (const std::string& sender : waiting.left) scene.forget_sender(sender);
}

void WorldServer::Impl::save() {
    save_credit_s = 0.0;
    SavedWorld saved;
    scene.save(saved);
    saver.put(std::move(saved));
}

// On the simulating thread, which waits for the disk: nothing else may happen to the world
// meanwhile. People come back with their next mesh.
void WorldServer::Impl::restore() {
    auto restored = load_scene(config);
    if (!restored) return app::log::error("restore_failed {}", restored.error().message);
    if (!*restored) return app::log::warn("restore_failed nothing was saved yet");
    for (SceneChange& change : scene.all()) {
        change.is_gone = true;
        outbox.put(change);
    }
    scene = std::move(**restored);
    for (const SceneChange& change : scene.all()) outbox.put(change);
    app::log::info("state_restored tick={}", scene.world().counters().num_ticks);
}

void WorldServer::Impl::apply_people() {
    people.take_all([&](const std::string& site, std::optional<physics::PersonShape>&& shape) {
        if (!shape) return scene.world().remove_person(site);
        scene.world().set_person(site, *shape);
        const std::lock_guard lock(status_mutex);
        capture_to_collision.add(Timestamp::now() - shape->capture_time);
    });
}

void WorldServer::Impl::send_state(Timestamp due) {
    send_credit += config.send_hz / config.tick_hz;
    if (send_credit < 1.0) return;
    send_credit -= 1.0;
    bus::SceneState state;
    scene.get_state(config.bus.world, due, state);
    std::vector<bus::SoftBodyState> soft_states;
    scene.get_soft_states(due, soft_states);
    outbox.put(std::move(state), std::move(soft_states));
}

// What the world did on its own, the hash now and then, and the file.
void WorldServer::Impl::look_after() {
    const double tick_s = 1.0 / config.tick_hz;
    scene.world().take_incidents(incidents);
    for (const physics::Incident& incident : incidents) {
        incidents_log.warn(
            fmt::format("object {} {}", incident.object, physics::describe(incident.kind)));
        if (const auto change = scene.forget_removed(incident)) outbox.put(*change);
    }
    hash_credit_s += tick_s;
    const bool is_hash_due = hash_credit_s >= kHashPeriodS;
    const std::uint64_t tick = scene.world().counters().num_ticks;
    const std::uint64_t hash = is_hash_due ? scene.world().state_hash() : 0;
    if (is_hash_due) {
        hash_credit_s = 0.0;
        app::log::info("state_hash tick={} hash={:016x}", tick, hash);
    }
    save_credit_s += tick_s;
    if (saver.is_on() && config.save_every_s > 0.0 && save_credit_s >= config.save_every_s) save();
    const std::lock_guard lock(status_mutex);
    if (is_hash_due) {
        figures.state_tick = tick;
        figures.state_hash = hash;
    }
    if (!incidents.empty()) {
        figures.num_resets += incidents.size();
        figures.last_reset = incidents.back().object;
    }
    figures.num_objects = scene.num_objects();
    figures.num_grabs = scene.world().num_grabs();
    counters = scene.world().counters();
}

void WorldServer::Impl::step(Timestamp due) {
    const Clock::time_point begin = Clock::now();
    apply_commands();
    apply_people();
    scene.world().tick();
    send_state(due);
    look_after();
    const std::lock_guard lock(status_mutex);
    step_times.add(Clock::now() - begin);
}

void WorldServer::Impl::simulate(std::stop_token stop) {
    const std::chrono::nanoseconds tick(static_cast<std::int64_t>(1e9 / config.tick_hz));
    const Clock::time_point start = Clock::now();
    Pace pace(tick, kMaxCatchUpTicks, start);
    while (!stop.stop_requested()) {
        sleep_until(pace.next(), stop);
        const Clock::time_point now = Clock::now();
        for (int i = pace.num_due(now); i > 0 && !stop.stop_requested(); --i) {
            // when it was due, on the clock that states are stamped with
            const std::chrono::nanoseconds ahead = pace.next() - i * tick - Clock::now();
            step(Timestamp::now() + ahead);
        }
        num_skipped_ticks = pace.num_skipped();
        const double seconds = std::chrono::duration<double>(now - start).count();
        if (config.seconds > 0.0 && seconds >= config.seconds) return;
    }
}

void WorldServer::Impl::publish(std::stop_token stop) {
    RateMeter step_rate;
    RateMeter byte_rate;
    Clock::time_point next_status = Clock::now();
    std::uint64_t last_skipped = 0;
    while (!stop.stop_requested()) {
        publisher.send(outbox.take(stop, next_status));

        const Clock::time_point now = Clock::now();
        if (now < next_status) continue;
        next_status = std::max(next_status + kStatusPeriod, now);
        {
            const std::lock_guard lock(status_mutex);
            figures.steps_per_s = step_rate.update(counters.num_ticks, now);
            figures.bytes_per_s = byte_rate.update(publisher.num_bytes(), now);
        }
        publisher.send(status());
        const std::uint64_t skipped = num_skipped_ticks;
        if (skipped > last_skipped) {
            app::log::warn("ticks_skipped num={} the machine is too slow or busy",
                           skipped - last_skipped);
        }
        last_skipped = skipped;
    }
}

bus::WorldStatus WorldServer::Impl::status() const {
    const std::lock_guard lock(status_mutex);
    bus::WorldStatus status = figures;
    status.world = config.bus.world;
    status.time = Timestamp::now();
    status.num_meshes_received = num_meshes;
    status.num_rejected = num_rejected;
    status.num_refused = num_refused;
    status.num_sites = num_sites;
    status.num_skipped_ticks = num_skipped_ticks;
    status.num_saves = saver.num_saves();
    status.num_bytes_published = publisher.num_bytes();
    status.resident_bytes = app::resident_bytes();
    status.num_steps = counters.num_ticks;
    status.num_contacts = counters.num_contact_ticks;
    status.capture_to_collision = to_summary(capture_to_collision.quantiles());
    status.step = to_summary(step_times.quantiles());
    return status;
}

namespace {

// As it was saved, or else as it is described.
Expected<Scene> start_scene(const WorldServerConfig& config) {
    auto described = Scene::create(config);
    if (!described || config.state_file.empty()) return described;
    auto saved = load_scene(config);
    if (!saved) {
        app::log::error("restore_failed {}; the world starts as described", saved.error().message);
        return described;
    }
    if (!*saved) return described;
    app::log::info("state_restored file={} tick={}",
                   config.state_file.string(),
                   (*saved)->world().counters().num_ticks);
    return std::move(**saved);
}

}  // namespace

WorldServer::WorldServer(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
WorldServer::~WorldServer() = default;

Expected<std::unique_ptr<WorldServer>> WorldServer::create(const WorldServerConfig& config,
                                                           std::stop_token stop) {
    if (const auto valid = check(config); !valid) return tl::unexpected(valid.error());
    auto scene = start_scene(config);
    if (!scene) return tl::unexpected(scene.error());
    auto endpoints = Endpoints::create(config.bus);
    if (!endpoints) return tl::unexpected(endpoints.error());
    auto impl = std::make_unique<Impl>(config, std::move(*endpoints), std::move(*scene));
    auto member = joining::join_world(
        impl->endpoints.participant,
        bus::ProgramKind::kWorldServer,
        config.bus.world,
        [self = impl.get()](const Error& lost) {
            {
                const std::lock_guard lock(self->lost_mutex);
                self->lost = lost;
            }
            self->end.request_stop();
        },
        stop);
    if (!member) return tl::unexpected(member.error());
    impl->membership = std::move(*member);
    return std::unique_ptr<WorldServer>(new WorldServer(std::move(impl)));
}

Expected<void> WorldServer::run(std::stop_token stop) {
    {
        const std::stop_callback pass_on(stop, [this] { impl_->end.request_stop(); });
        std::jthread receiver([this](std::stop_token own) { impl_->receive(std::move(own)); });
        std::jthread publisher([this](std::stop_token own) { impl_->publish(std::move(own)); });
        std::jthread saver([this](std::stop_token own) { impl_->saver.run(std::move(own)); });
        impl_->simulate(impl_->end.get_token());
    }  // the threads are stopped and joined here
    if (impl_->saver.is_on()) {
        SavedWorld last;
        impl_->scene.save(last);
        impl_->saver.save(last);
    }
    app::log::info("stopped deadlines_missed={}", impl_->endpoints.meshes.num_deadlines_missed());
    const std::lock_guard lock(impl_->lost_mutex);
    if (impl_->lost) return tl::unexpected(*impl_->lost);
    return {};
}

bus::WorldStatus WorldServer::status() const { return impl_->status(); }

}  // namespace atrium::world_server
