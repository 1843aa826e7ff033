#include "world_server/world_server.hpp"

#include "core/app/log.hpp"
#include "core/app/process.hpp"
#include "core/app/program.hpp"
#include "core/base/processor_use.hpp"
#include "core/base/statistics.hpp"
#include "core/presence/join_world.hpp"
#include "core/status/bottleneck.hpp"
#include "world_server/command_reception.hpp"
#include "world_server/description/doubts.hpp"
#include "world_server/endpoints.hpp"
#include "world_server/mesh_preparation.hpp"
#include "world_server/publisher.hpp"
#include "world_server/reception.hpp"
#include "world_server/simulation.hpp"

#include <atomic>
#include <chrono>
#include <map>
#include <mutex>
#include <string>
#include <thread>

namespace atrium::world_server {
namespace {

using Clock = std::chrono::steady_clock;
constexpr std::chrono::milliseconds kStatusPeriod{1000};
constexpr std::chrono::seconds kSkippedPeriod{30};  // between lines about skipped ticks

// The reason to end the process without a stop request.
struct Loss {
    std::mutex mutex;  // guards error
    std::optional<Error> error;
    std::stop_source end;
};

}  // namespace

struct WorldServer::Impl {
    Impl(const WorldServerConfig& server_config,
         Endpoints server_endpoints,
         std::shared_ptr<Loss> server_loss,
         std::unique_ptr<presence::Membership> server_membership,
         Scene server_scene);

    // receiving thread; never decodes
    void receive(std::stop_token stop);
    void take_descriptions();
    void take_meshes();
    void take_commands();
    void take_edits();
    void count_rejected(const bus::TakeReport& report);
    void reject(const std::string& why);
    void refuse(const std::string& why);  // a command or an edit

    // publishing thread
    void publish(std::stop_token stop);

    bus::WorldStatus status() const;

    const WorldServerConfig config;
    Endpoints endpoints;
    Publisher publisher{endpoints};  // of the publishing thread
    app::log::OncePerSecond rejections_log;
    Simulation simulation;

    std::atomic<std::uint64_t> num_meshes{0};
    std::atomic<std::uint64_t> num_superseded{0};  // meshes taken together with a newer one
    std::atomic<std::uint64_t> num_rejected{0};
    std::atomic<std::uint64_t> num_refused{0};  // refused before they were queued
    std::atomic<double> steps_per_s{0.0};
    std::atomic<double> bytes_per_s{0.0};
    std::atomic<double> first_output_s{0.0};  // 0: no state published yet
    ProcessorMeter processor_meter;           // of the publishing thread
    mutable std::mutex processor_mutex;       // guards processor
    ProcessorUse processor;                   // last measurement

    MeshPreparation preparation;  // fed by the reception
    Reception reception;          // of the receiving thread

    std::shared_ptr<Loss> loss;
    std::unique_ptr<presence::Membership> membership;  // destroyed first: it uses the endpoints
};

WorldServer::Impl::Impl(const WorldServerConfig& server_config,
                        Endpoints server_endpoints,
                        std::shared_ptr<Loss> server_loss,
                        std::unique_ptr<presence::Membership> server_membership,
                        Scene server_scene)
    : config(server_config),
      endpoints(std::move(server_endpoints)),
      simulation(config, std::move(server_scene), [this](const std::string& why) { reject(why); }),
      preparation(simulation.people(),
                  MeshPreparation::threads_for_machine(),
                  [this](const std::string& why) { reject(why); }),
      reception(
          config,
          preparation,
          [this](const bus::SitePlacement& placement) { simulation.outbox().put(placement); },
          [this](const std::string& why) { reject(why); }),
      loss(std::move(server_loss)),
      membership(std::move(server_membership)) {
    for (const NamedPlacement& placement : config.placements) {
        simulation.outbox().put(bus::SitePlacement{placement.site, placement.world_from_site});
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

void WorldServer::Impl::take_descriptions() {
    count_rejected(endpoints.descriptions.take(
        [&](bus::SiteDescription&& description) { reception.put(description); },
        [&](const bus::SiteDescription& gone) { reception.end(gone); }));
}

// Takes the samples and keeps the newest of each site. Several arrive together if one was
// retransmitted.
void WorldServer::Impl::take_meshes() {
    std::map<std::string, std::pair<bus::SiteMesh, Timestamp>> newest;  // with time of writing
    count_rejected(endpoints.meshes.take_written(
        [&](bus::SiteMesh&& message, Timestamp written) {
            ++num_meshes;
            const std::string site = message.site;
            if (!newest.insert_or_assign(site, std::pair(std::move(message), written)).second)
                ++num_superseded;
        },
        [&](const bus::SiteMesh& gone, bus::Ending /*how*/) {
            newest.erase(gone.site);
            reception.end(gone);
        }));
    for (auto& [site, mesh] : newest) reception.put(std::move(mesh.first), mesh.second);
}

void WorldServer::Impl::refuse(const std::string& why) {
    ++num_refused;
    reject(why);
}

void WorldServer::Impl::take_commands() {
    const Clock::time_point now = Clock::now();
    count_rejected(endpoints.commands.take(
        [&](bus::SceneCommand&& command) {
            if (const auto why = world_server::receive(simulation, std::move(command), now))
                refuse(*why);
        },
        [&](const bus::SceneCommand& gone) { forget_sender(simulation, gone); }));
}

void WorldServer::Impl::take_edits() {
    const Clock::time_point now = Clock::now();
    count_rejected(endpoints.edits.take(
        [&](bus::SceneEdit&& edit) {
            if (const auto why = world_server::receive(simulation, std::move(edit), now))
                refuse(*why);
        },
        [&](const bus::SceneEdit& gone) { forget_sender(simulation, gone); }));
}

void WorldServer::Impl::receive(std::stop_token stop) {
    const std::stop_callback wake(stop, [this] { endpoints.waiter.wake(); });
    while (!stop.stop_requested()) {
        if (!endpoints.waiter.wait(std::chrono::milliseconds(500))) continue;
        take_descriptions();
        take_meshes();
        take_commands();
        take_edits();
    }
}

void WorldServer::Impl::publish(std::stop_token stop) {
    RateMeter step_rate;
    RateMeter byte_rate;
    Outbox::Content content;
    Clock::time_point next_status = Clock::now();
    std::uint64_t num_skipped = 0;  // told so far
    Clock::time_point next_skipped = next_status;
    atrium::status::OverloadLog overload(bus::ProgramKind::kWorldServer);
    while (!stop.stop_requested()) {
        simulation.outbox().take(content, stop, next_status);
        publisher.send(content);
        if (content.has_state && first_output_s == 0.0) first_output_s = app::seconds_since_start();
        simulation.want_people(publisher.has_proxy_readers());

        const Clock::time_point now = Clock::now();
        if (now < next_status) continue;
        next_status = std::max(next_status + kStatusPeriod, now);
        bus::WorldStatus sent = status();
        sent.steps_per_s = steps_per_s = step_rate.update(sent.num_steps, now);
        sent.bytes_per_s = bytes_per_s = byte_rate.update(sent.num_bytes_published, now);
        sent.processor = processor_meter.update(now);  // after the losses, see bottlenecks()
        {
            const std::lock_guard lock(processor_mutex);
            processor = sent.processor;
        }
        publisher.send(sent);
        if (const auto line = overload.look(atrium::status::figures_of(sent), now)) {
            app::log::warn("{}", *line);
        } else if (sent.num_skipped_ticks > num_skipped && now >= next_skipped) {
            app::log::warn("ticks_skipped num={}", sent.num_skipped_ticks - num_skipped);
        } else {
            continue;
        }
        num_skipped = sent.num_skipped_ticks;
        next_skipped = now + kSkippedPeriod;
    }
}

bus::WorldStatus WorldServer::Impl::status() const {
    bus::WorldStatus status;
    simulation.fill(status);
    status.world = config.bus.world;
    status.time = Timestamp::now();
    status.num_meshes_received = num_meshes;
    status.num_meshes_dropped = num_superseded + preparation.num_dropped();
    status.prepare = to_summary(preparation.times());
    status.num_rejected = num_rejected;
    status.num_refused += num_refused;
    status.num_sites = reception.num_present();
    status.num_bytes_published = publisher.num_bytes();
    status.steps_per_s = steps_per_s;
    status.bytes_per_s = bytes_per_s;
    status.resident_bytes = app::resident_bytes();
    status.first_output_s = first_output_s;
    const std::lock_guard lock(processor_mutex);
    status.processor = processor;
    return status;
}

WorldServer::WorldServer(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
WorldServer::~WorldServer() = default;

Expected<std::unique_ptr<WorldServer>> WorldServer::create(const WorldServerConfig& given,
                                                           std::stop_token stop) {
    if (const auto valid = check(given); !valid) return tl::unexpected(valid.error());
    const SavedWorldsFolder folder(given.saved_folder, static_cast<std::size_t>(given.max_saved));
    if (const auto open = folder.open(); !open) return tl::unexpected(open.error());
    auto described = Scene::create(given);
    if (!described) return tl::unexpected(described.error());
    WorldServerConfig config = given;
    config.world_file_hash = described->description_hash();
    auto endpoints = Endpoints::create(config.bus);
    if (!endpoints) return tl::unexpected(endpoints.error());
    const auto loss = std::make_shared<Loss>();
    auto member = presence::join_world(
        endpoints->participant,
        bus::ProgramKind::kWorldServer,
        config.bus.world,
        [loss](const Error& error) {
            {
                const std::lock_guard lock(loss->mutex);
                loss->error = error;
            }
            loss->end.request_stop();
        },
        stop);
    if (!member) return tl::unexpected(member.error());
    // only now: the state file belongs to the server that holds the name
    auto scene = start_scene(config, std::move(*described));
    if (!scene) return tl::unexpected(scene.error());
    for (const std::string& doubt : doubts_about(scene->description(), config.tick_hz))
        app::log::warn("{}", doubt);
    const std::size_t num_soft = scene->num_soft();
    app::log::info("running world={} objects={} soft={}",
                   config.bus.world,
                   scene->num_objects() - num_soft,
                   num_soft);
    return std::unique_ptr<WorldServer>(new WorldServer(std::make_unique<Impl>(
        config, std::move(*endpoints), loss, std::move(*member), std::move(*scene))));
}

Expected<void> WorldServer::run(std::stop_token stop) {
    {
        const std::stop_callback pass_on(stop, [this] { impl_->loss->end.request_stop(); });
        std::jthread receiver([this](std::stop_token own) { impl_->receive(std::move(own)); });
        std::jthread publisher([this](std::stop_token own) { impl_->publish(std::move(own)); });
        std::jthread saver(
            [this](std::stop_token own) { impl_->simulation.saver().run(std::move(own)); });
        std::jthread editor(
            [this](std::stop_token own) { impl_->simulation.edit_worker().run(std::move(own)); });
        impl_->simulation.run(impl_->loss->end.get_token());
    }  // the threads are stopped and joined here
    impl_->preparation.stop();
    const auto saved = impl_->simulation.save_last();
    const bus::WorldStatus last = status();
    app::log::info("stopped deadlines_missed={} {}",
                   impl_->endpoints.meshes.num_deadlines_missed(),
                   atrium::status::process_fields(last.processor, last.first_output_s));
    const std::lock_guard lock(impl_->loss->mutex);
    if (impl_->loss->error) return tl::unexpected(*impl_->loss->error);
    if (!saved)
        return make_error(ErrorKind::kInternal, "the last save failed: " + saved.error().message);
    return {};
}

bus::WorldStatus WorldServer::status() const { return impl_->status(); }

}  // namespace atrium::world_server
