#include "world_server/world_server.hpp"

#include "core/app/log.hpp"
#include "core/app/program.hpp"
#include "core/base/statistics.hpp"
#include "core/joining/join_world.hpp"
#include "world_server/endpoints.hpp"
#include "world_server/outbox.hpp"
#include "world_server/pace.hpp"
#include "world_server/people_inbox.hpp"
#include "world_server/scene.hpp"
#include "world_server/site_register.hpp"

#include <fmt/format.h>

#include <atomic>
#include <chrono>
#include <deque>
#include <mutex>
#include <set>
#include <thread>

namespace atrium::world_server {
namespace {

using Clock = Pace::Clock;
constexpr int kMaxCatchUpTicks = 4;  // what a tick of 120 Hz may be late by is one mesh period
constexpr std::size_t kMaxCommands = 256;  // that wait for the next tick; more are refused
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
    void step();
    void apply_commands();
    void apply_people();
    void report_incidents();

    // the publishing thread
    void publish(std::stop_token stop);
    template <typename Message>
    void write(bus::Writer<Message>& writer, const Message& message);

    bus::WorldStatus status() const;

    const WorldServerConfig config;
    Endpoints endpoints;
    Scene scene;         // of the simulating thread
    SiteRegister sites;  // of the receiving thread, as is the next one
    std::set<std::string> described_sites;
    PeopleInbox people;
    Outbox outbox;
    std::mutex commands_mutex;
    std::deque<bus::SceneCommand> commands;
    double send_credit = 0.0;  // states that should have been sent by now
    app::log::OncePerSecond rejections_log;
    app::log::OncePerSecond incidents_log;
    std::vector<physics::Incident> incidents;  // scratch of the simulating thread
    app::log::OncePerSecond publish_log;

    std::atomic<std::uint64_t> num_meshes{0};
    std::atomic<std::uint64_t> num_rejected{0};
    std::atomic<std::uint64_t> num_sites{0};
    std::atomic<std::uint64_t> num_skipped_ticks{0};
    mutable std::mutex status_mutex;  // guards the rest
    physics::WorldCounters counters;
    LatencyWindow capture_to_collision;
    double steps_per_s = 0.0;

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
      sites(config.placements, static_cast<std::size_t>(config.max_sites), config.person) {
    for (const bus::SceneObject& object : scene.objects()) outbox.put(SceneChange{object, false});
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
    count_rejected(endpoints.commands.take([&](bus::SceneCommand&& command) {
        {
            const std::lock_guard lock(commands_mutex);
            if (commands.size() < kMaxCommands) return commands.push_back(std::move(command));
        }
        reject("command of " + command.sender + ": too many at once");
    }));
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

void WorldServer::Impl::apply_commands() {
    std::deque<bus::SceneCommand> waiting;
    {
        const std::lock_guard lock(commands_mutex);
        waiting.swap(commands);
    }
    for (const bus::SceneCommand& command : waiting) {
        const auto changes = scene.apply(command);
        if (!changes) {
            reject("command of " + command.sender + ": " + changes.error().message);
            continue;
        }
        for (const SceneChange& change : *changes) outbox.put(change);
    }
}

void WorldServer::Impl::apply_people() {
    people.take_all([&](const std::string& site, std::optional<physics::PersonShape>&& shape) {
        if (!shape) return scene.world().remove_person(site);
        scene.world().set_person(site, *shape);
        const std::lock_guard lock(status_mutex);
        capture_to_collision.add(Timestamp::now() - shape->capture_time);
    });
}

void WorldServer::Impl::report_incidents() {
    for (const SceneChange& change : scene.take_removed(incidents)) outbox.put(change);
    for (const physics::Incident& incident : incidents) {
        incidents_log.warn(
            fmt::format("object {} {}", incident.object, physics::describe(incident.kind)));
    }
}

void WorldServer::Impl::step() {
    apply_commands();
    apply_people();
    scene.world().tick();
    report_incidents();
    send_credit += config.send_hz / config.tick_hz;
    if (send_credit >= 1.0) {
        send_credit -= 1.0;
        bus::SceneState state;
        scene.get_state(config.bus.world, state);
        outbox.put(std::move(state));
    }
    const std::lock_guard lock(status_mutex);
    counters = scene.world().counters();
}

void WorldServer::Impl::simulate(std::stop_token stop) {
    const std::chrono::nanoseconds tick(static_cast<std::int64_t>(1e9 / config.tick_hz));
    const Clock::time_point start = Clock::now();
    Pace pace(tick, kMaxCatchUpTicks, start);
    while (!stop.stop_requested()) {
        sleep_until(pace.next(), stop);
        const Clock::time_point now = Clock::now();
        for (int i = pace.num_due(now); i > 0 && !stop.stop_requested(); --i) step();
        num_skipped_ticks = pace.num_skipped();
        const double seconds = std::chrono::duration<double>(now - start).count();
        if (config.seconds > 0.0 && seconds >= config.seconds) return;
    }
}

template <typename Message>
void WorldServer::Impl::write(bus::Writer<Message>& writer, const Message& message) {
    if (const auto written = writer.write(message); !written) {
        publish_log.warn("publish_failed " + written.error().message);
    }
}

void WorldServer::Impl::publish(std::stop_token stop) {
    RateMeter rate;
    Clock::time_point next_status = Clock::now();
    std::uint64_t last_skipped = 0;
    while (!stop.stop_requested()) {
        const Outbox::Content content = outbox.take(stop, next_status);
        for (const SceneChange& change : content.changes) {
            if (!change.is_gone) {
                write(endpoints.objects, change.object);
            } else if (const auto gone = endpoints.objects.dispose(change.object); !gone) {
                publish_log.warn("publish_failed " + gone.error().message);
            }
        }
        for (const auto& placement : content.placements) write(endpoints.placements, placement);
        if (content.state) write(endpoints.states, *content.state);

        const Clock::time_point now = Clock::now();
        if (now < next_status) continue;
        next_status = std::max(next_status + kStatusPeriod, now);
        {
            const std::lock_guard lock(status_mutex);
            steps_per_s = rate.update(counters.num_ticks, now);
        }
        write(endpoints.statuses, status());
        const std::uint64_t skipped = num_skipped_ticks;
        if (skipped > last_skipped) {
            app::log::warn("ticks_skipped num={} the machine is too slow or busy",
                           skipped - last_skipped);
        }
        last_skipped = skipped;
    }
}

bus::WorldStatus WorldServer::Impl::status() const {
    bus::WorldStatus status;
    status.world = config.bus.world;
    status.time = Timestamp::now();
    status.num_meshes_received = num_meshes;
    status.num_rejected = num_rejected;
    status.num_sites = num_sites;
    status.resident_bytes = app::resident_bytes();
    const std::lock_guard lock(status_mutex);
    status.num_steps = counters.num_ticks;
    status.num_contacts = counters.num_contact_ticks;
    status.steps_per_s = steps_per_s;
    status.capture_to_collision = to_summary(capture_to_collision.quantiles());
    return status;
}

WorldServer::WorldServer(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
WorldServer::~WorldServer() = default;

Expected<std::unique_ptr<WorldServer>> WorldServer::create(const WorldServerConfig& config,
                                                           std::stop_token stop) {
    if (const auto valid = check(config); !valid) return tl::unexpected(valid.error());
    auto scene = Scene::create(config);
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
        impl_->simulate(impl_->end.get_token());
    }  // the threads are stopped and joined here
    app::log::info("stopped deadlines_missed={}", impl_->endpoints.meshes.num_deadlines_missed());
    const std::lock_guard lock(impl_->lost_mutex);
    if (impl_->lost) return tl::unexpected(*impl_->lost);
    return {};
}

bus::WorldStatus WorldServer::status() const { return impl_->status(); }

}  // namespace atrium::world_server
