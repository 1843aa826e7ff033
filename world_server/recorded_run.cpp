#include "world_server/recorded_run.hpp"

#include "core/app/log.hpp"
#include "core/app/progress.hpp"
#include "core/recording/world_file.hpp"
#include "world_server/command_reception.hpp"
#include "world_server/description/doubts.hpp"
#include "world_server/mesh_preparation.hpp"
#include "world_server/pace.hpp"
#include "world_server/publisher.hpp"
#include "world_server/recorded_input.hpp"
#include "world_server/recorded_output.hpp"
#include "world_server/simulation.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <utility>

namespace atrium::world_server {
namespace {

using Clock = std::chrono::steady_clock;

// Overload for std::visit.
template <typename... Functions>
struct Visitor : Functions... {
    using Functions::operator()...;
};
template <typename... Functions>
Visitor(Functions...) -> Visitor<Functions...>;

// Rates of commands are those of the recording.
CommandRates::Clock::time_point clock_of(Timestamp time) {
    return CommandRates::Clock::time_point(std::chrono::nanoseconds(time.ns));
}

Expected<std::shared_ptr<const recording::WorldFile>> open_recording(
    const std::filesystem::path& file) {
    auto world = recording::WorldFile::open(file);
    if (world && (*world)->sites().empty()) {
        return make_error(ErrorKind::kInvalidData,
                          fmt::format("{}: the recording has no site, so there are no people for "
                                      "the world",
                                      file.string()));
    }
    return world;
}

bool is_of_files(const bus::SceneCommand& command) {
    return command.kind == bus::CommandKind::kSave || command.kind == bus::CommandKind::kRestore;
}

// The configuration without what belongs to a live world, and with the recorded places of sites
// that the world file does not name.
WorldServerConfig config_for(const WorldServerConfig& given, const recording::WorldFile& world) {
    WorldServerConfig config = given;
    config.state_file.clear();
    config.bus.world = world.world();
    for (const recording::WorldFile::Kept& kept : world.kept()) {
        if (config.placements.size() >= static_cast<std::size_t>(config.max_sites)) break;
        const recording::PlayedSample& sample = kept.sample;
        if (sample.topic->name() != bus::topic_name<bus::SitePlacement>() ||
            sample.raw.kind != bus::RawKind::kSample ||
            !std::ranges::binary_search(world.sites(), kept.key) ||
            std::ranges::find(config.placements, kept.key, &NamedPlacement::site) !=
                config.placements.end())
            continue;
        if (const auto placement = bus::from_raw<bus::SitePlacement>(sample.raw))
            config.placements.push_back({kept.key, placement->world_from_site});
    }
    return config;
}

}  // namespace

struct RecordedRun::Impl {
    Impl(WorldServerConfig run_config,
         std::shared_ptr<const recording::WorldFile> run_world,
         Scene scene,
         std::unique_ptr<RecordingSink> run_sink);

    void reject(const std::string& why);
    void apply(RecordedItem& item, Timestamp time);
    void apply(bus::SceneCommand&& command, Timestamp time);
    void apply(bus::SceneEdit&& edit, Timestamp time);
    void copy(const recording::PlayedSample& sample);
    void write(bool is_second);
    RecordedState state() const;
    std::uint64_t num_ticks() const;
    Timestamp time_of(std::uint64_t number) const;

    const WorldServerConfig config;
    const std::shared_ptr<const recording::WorldFile> world;
    std::uint64_t tick = 0;
    std::uint64_t num_rejected = 0;
    app::log::OncePerSecond rejections_log;
    Simulation simulation;
    RecordedInput input;
    std::unique_ptr<RecordingSink> sink;  // null: no output
    std::optional<RecordedOutputs> outputs;
    std::optional<BasicPublisher<RecordedOutputs>> publisher;
    Outbox::Content content;
};

RecordedRun::Impl::Impl(WorldServerConfig run_config,
                        std::shared_ptr<const recording::WorldFile> run_world,
                        Scene scene,
                        std::unique_ptr<RecordingSink> run_sink)
    : config(std::move(run_config)),
      world(std::move(run_world)),
      simulation(config, std::move(scene), [this](const std::string& why) { reject(why); }),
      input(config,
            world,
            config.recording.threads > 0 ? static_cast<std::size_t>(config.recording.threads)
                                         : MeshPreparation::threads_for_machine(),
            [this](const std::string& why) { reject(why); }),
      sink(std::move(run_sink)) {
    for (const NamedPlacement& placement : config.placements)
        simulation.outbox().put(bus::SitePlacement{placement.site, placement.world_from_site});
    if (!sink) return;
    outputs.emplace(*sink);
    publisher.emplace(*outputs);
}

void RecordedRun::Impl::reject(const std::string& why) {
    ++num_rejected;
    rejections_log.warn("rejected " + why);
}

Timestamp RecordedRun::Impl::time_of(std::uint64_t number) const {
    return world->begin() + std::chrono::nanoseconds(
                                std::llround(static_cast<double>(number) * 1e9 / config.tick_hz));
}

std::uint64_t RecordedRun::Impl::num_ticks() const {
    double seconds = std::chrono::duration<double>(world->duration()).count();
    if (config.seconds > 0.0) seconds = std::min(seconds, config.seconds);
    return static_cast<std::uint64_t>(std::ceil(seconds * config.tick_hz));
}

void RecordedRun::Impl::apply(bus::SceneCommand&& command, Timestamp time) {
    if (is_of_files(command)) return;
    if (const auto why = receive(simulation, std::move(command), clock_of(time))) reject(*why);
}

void RecordedRun::Impl::apply(bus::SceneEdit&& edit, Timestamp time) {
    if (edit.kind == bus::EditKind::kSaveWorld) return;
    if (const auto why = receive(simulation, std::move(edit), clock_of(time))) reject(*why);
    simulation.edit_worker().do_waiting();
}

void RecordedRun::Impl::apply(RecordedItem& item, Timestamp time) {
    copy(item.sample);
    for (RecordedNews& news : item.news) {
        std::visit(
            Visitor{[&](bus::SitePlacement& placement) { simulation.outbox().put(placement); },
                    [&](PreparedShape& prepared) {
                        auto shape = prepared.shape.get();
                        if (!shape) return reject(shape.error().message);
                        simulation.people().put(prepared.site, std::move(*shape));
                    },
                    [&](EndedPerson& ended) { simulation.people().put(ended.site, std::nullopt); },
                    [&](bus::SceneCommand& command) { apply(std::move(command), time); },
                    [&](EndedCommands& ended) { forget_sender(simulation, ended.key); },
                    [&](bus::SceneEdit& edit) { apply(std::move(edit), time); },
                    [&](EndedEdits& ended) { forget_sender(simulation, ended.key); }},
            news);
    }
}

void RecordedRun::Impl::copy(const recording::PlayedSample& sample) {
    if (!sink || is_of_world_server(*sample.topic)) return;
    sink->write({sample.topic,
                 sample.raw.kind,
                 sample.time,
                 sample.raw.written,
                 {sample.raw.cdr.begin(), sample.raw.cdr.end()}});
}

void RecordedRun::Impl::write(bool is_second) {
    if (!sink) return;
    sink->set_time(time_of(tick));
    simulation.outbox().take(content, {}, Clock::time_point{});
    publisher->send(content);
    if (!is_second) return;
    bus::WorldStatus status;
    simulation.fill(status);
    status.world = config.bus.world;
    status.time = sink->time();
    status.num_meshes_received = input.num_meshes();
    status.num_rejected = num_rejected;
    status.num_sites = input.num_sites();
    status.num_bytes_published = publisher->num_bytes();
    status.steps_per_s = config.tick_hz;
    publisher->send(status);
}

RecordedState RecordedRun::Impl::state() const {
    return {tick, static_cast<double>(tick) / config.tick_hz, simulation.state_hash()};
}

RecordedRun::RecordedRun(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
RecordedRun::~RecordedRun() = default;

Expected<std::unique_ptr<RecordedRun>> RecordedRun::create(const WorldServerConfig& given) {
    auto world = open_recording(given.recording.file);
    if (!world) return tl::unexpected(world.error());
    for (const std::string& line : (*world)->warnings()) app::log::warn("{}", line);
    WorldServerConfig config = config_for(given, **world);
    if (const auto valid = check(config); !valid) return tl::unexpected(valid.error());
    auto scene = Scene::create(config);
    if (!scene) return tl::unexpected(scene.error());
    for (const std::string& doubt : doubts_about(scene->description(), config.tick_hz))
        app::log::warn("{}", doubt);
    std::unique_ptr<RecordingSink> sink;
    if (!config.recording.output.empty()) {
        auto created = create_sink(config.recording.output, **world);
        if (!created) return tl::unexpected(created.error());
        sink = std::move(*created);
    }
    return std::unique_ptr<RecordedRun>(new RecordedRun(std::make_unique<Impl>(
        std::move(config), std::move(*world), std::move(*scene), std::move(sink))));
}

Expected<RecordedState> RecordedRun::run(
    std::stop_token stop, const std::function<void(const RecordedState&)>& on_second) {
    Impl& run = *impl_;
    const Clock::time_point start = Clock::now();
    const std::uint64_t num_ticks = run.num_ticks();
    double next_second = 1.0;
    while (run.tick < num_ticks && !(run.sink && run.sink->has_failed())) {
        const Timestamp time = run.time_of(run.tick + 1);
        if (run.config.recording.real_time) sleep_until(start + (time - run.world->begin()), stop);
        if (stop.stop_requested()) break;
        while (auto item = run.input.next(time)) run.apply(*item, item->sample.time);
        run.simulation.step_recorded(time);
        ++run.tick;
        const bool is_second =
            static_cast<double>(run.tick) >= next_second * run.config.tick_hz - 1e-9;
        run.write(is_second);
        if (!is_second) continue;
        next_second += 1.0;
        if (on_second) on_second(run.state());
    }
    if (run.sink) {
        if (const auto done = run.sink->finish(); !done) return tl::unexpected(done.error());
    }
    if (run.input.num_meshes() == 0 && !stop.stop_requested()) {
        return make_error(ErrorKind::kInvalidData,
                          fmt::format("{}: no mesh could be read, of {} in the recording",
                                      run.config.recording.file.string(),
                                      run.world->num_samples()["SiteMesh"]));
    }
    return run.state();
}

RecordedCounts RecordedRun::counts() const {
    bus::WorldStatus status;
    impl_->simulation.fill(status);
    return {impl_->input.num_meshes(),
            impl_->num_rejected,
            impl_->input.num_damaged(),
            status.num_contacts};
}

double RecordedRun::duration_s() const {
    return static_cast<double>(impl_->num_ticks()) / impl_->config.tick_hz;
}

Expected<void> check_recording(const RecordingOptions& options) {
    if (options.file.empty()) return {};
    const auto world = open_recording(options.file);
    if (!world) return tl::unexpected(world.error());
    std::error_code failure;
    if (!options.output.empty() && std::filesystem::exists(options.output, failure)) {
        return make_error(ErrorKind::kConfiguration,
                          fmt::format("{}: the file exists; remove it, or give another name",
                                      options.output.string()));
    }
    return {};
}

Expected<void> run_recorded(const WorldServerConfig& config, std::stop_token stop) {
    auto run = RecordedRun::create(config);
    if (!run) return tl::unexpected(run.error());
    const RecordingOptions& options = config.recording;
    app::log::info("running recording={} seconds={:.1f} output={}",
                   options.file.string(),
                   (*run)->duration_s(),
                   options.output.string());
    const Clock::time_point begin = Clock::now();
    app::Progress progress("second",
                           std::max<std::size_t>(1, static_cast<std::size_t>((*run)->duration_s())),
                           std::chrono::seconds(1),
                           begin);
    const auto last = (*run)->run(stop, [&](const RecordedState& state) {
        if (options.hashes)
            app::log::info("state_hash second={:.0f} tick={} hash={:016x}",
                           state.seconds,
                           state.tick,
                           state.hash);
        if (const auto line = progress.update(static_cast<std::size_t>(state.seconds)))
            app::log::info("{}", *line);
    });
    if (!last) return tl::unexpected(last.error());
    const RecordedCounts counts = (*run)->counts();
    const double took_s = std::chrono::duration<double>(Clock::now() - begin).count();
    app::log::info(
        "{} ticks={} seconds={:.2f} hash={:016x} speed={:.1f} meshes={} "
        "contact_ticks={} rejected={} damaged={}",
        stop.stop_requested() ? "stopped" : "ran",
        last->tick,
        last->seconds,
        last->hash,
        took_s > 0.0 ? last->seconds / took_s : 0.0,
        counts.num_meshes,
        counts.num_contact_ticks,
        counts.num_rejected,
        counts.num_damaged);
    return {};
}

}  // namespace atrium::world_server
