#include "core/presence/join_world.hpp"
#include "site_node/region_node.hpp"
#include "site_node/site_node.hpp"
#include "site_node/source/open_source.hpp"
#include "site_node/start_check.hpp"

#include <fmt/format.h>

#include <optional>

// Start of a site: everything that can fail.
namespace atrium::site_node {
namespace {

template <typename Message>
Expected<void> open(bus::Participant& participant, std::optional<bus::Writer<Message>>& writer) {
    auto made = bus::Writer<Message>::create(participant);
    if (!made) return tl::unexpected(made.error());
    writer = std::move(*made);
    return {};
}

Expected<std::vector<bus::Writer<bus::CameraTexture>>> open_textures(
    const bus::Participant& participant, std::size_t num_cameras) {
    std::vector<bus::Writer<bus::CameraTexture>> writers;
    while (writers.size() < num_cameras) {
        auto writer = bus::Writer<bus::CameraTexture>::create(participant);
        if (!writer) return tl::unexpected(writer.error());
        writers.push_back(std::move(*writer));
    }
    return writers;
}

bool may_record(const SiteNodeConfig& config) {
    return config.hosts.empty() &&
           (!config.record.folder.empty() || !config.record.orders.empty() ||
            config.record.pre_roll_s > 0.0);
}

// Checks the configuration against this rig and warns about suspicious settings.
Expected<void> check(const SiteNodeConfig& config, const config::Rig& rig) {
    const double period_quarter_ms = 250.0 / metaframe_rate_hz(config, rig);
    if (config.capture.tolerance_ms > period_quarter_ms) {
        return make_error(
            ErrorKind::kConfiguration,
            fmt::format("capture.tolerance_ms: must be at most a quarter of the period, {:.1f} ms, "
                        "got {}",
                        period_quarter_ms,
                        config.capture.tolerance_ms));
    }
    if (may_record(config)) {
        const auto options =
            recorder_options(config.record, config.capture, rig, metaframe_rate_hz(config, rig));
        if (auto fits = record::check_memory(options, rig.cameras.size()); !fits) return fits;
    }
    const HullStageOptions& hull = config.pipeline.hull;
    if (hull.partial_views && hull.min_views == 0) {
        app::log::warn(
            "hull.partial_views without hull.min_views: space that no camera sees counts as "
            "occupied");
    }
    return {};
}

// Checks the part of this host in a site on several hosts: it has to be the model part.
Expected<void> check_own_part(const SiteNodeConfig& config) {
    if (config.hosts.empty()) return {};
    const auto own = hosts::find_host(config.hosts, own_host(config));
    if (!own) return tl::unexpected(own.error());
    if (!own->is_model) {
        return make_error(
            ErrorKind::kConfiguration,
            fmt::format("{}: host: '{}' does not compute the hull (model = true): run camera_node "
                        "there",
                        own->place,
                        own->name));
    }
    if (!config.preview.empty()) {
        return make_error(ErrorKind::kConfiguration,
                          "--preview: the pictures stay on the hosts of the cameras: camera_node "
                          "--preview there");
    }
    return {};
}

// `hosts`: the same source, if the pictures are those of camera nodes.
Expected<std::unique_ptr<capture::FrameSource>> open_frames(const SiteNodeConfig& config,
                                                            const config::Rig& rig,
                                                            const bus::Participant& participant,
                                                            hosts::HostsSource*& hosts,
                                                            std::stop_token stop) {
    if (config.hosts.empty()) return open_source(config.capture, config.simulation, stop);
    auto source = hosts::HostsSource::open(
        participant,
        rig,
        {config.name,
         config.hosts,
         std::chrono::nanoseconds(static_cast<std::int64_t>(config.capture.deadline_ms * 1e6))});
    if (!source) return tl::unexpected(source.error());
    hosts = source->get();
    return std::unique_ptr<capture::FrameSource>(std::move(*source));
}

// Who computes the regions that other hosts have; null if none has any.
Expected<std::unique_ptr<hosts::RegionHosts>> open_region_hosts(
    const SiteNodeConfig& config,
    const config::Rig& rig,
    const HullStage& hull,
    const bus::Participant& participant) {
    hosts::RegionHostsOptions options;
    options.site = config.name;
    options.period =
        std::chrono::nanoseconds(static_cast<std::int64_t>(1e9 / metaframe_rate_hz(config, rig)));
    options.settings = hull_settings(config, rig);
    for (const hull::Region& region : hull.regions()) options.cameras.push_back(region.views);
    for (const hosts::HostEntry& host : config.hosts) {
        hosts::RegionHost computes{host.name, {}};
        for (std::uint32_t i = 0; i < config.pipeline.hull.regions.size(); ++i) {
            if (hosts::host_of_region(config.hosts, config.pipeline.hull.regions[i].name) == &host)
                computes.regions.push_back(i);
        }
        if (!computes.regions.empty()) options.hosts.push_back(std::move(computes));
    }
    if (options.hosts.empty()) return nullptr;
    return hosts::RegionHosts::open(participant, std::move(options));
}

rig_check::AgreementOptions agreement_options(const HullStageOptions& hull,
                                              const Pipeline& pipeline) {
    rig_check::AgreementOptions options;
    options.is_room_learned = pipeline.had_people();
    options.knows_outside = !hull.partial_views && hull.regions.empty();
    options.bounds = hull.bounds;
    return options;
}

std::string rig_file(const SiteNodeConfig& config) {
    return config.capture.source == "recording" ? (config.capture.recording / "rig.toml").string()
                                                : config.capture.rig.string();
}

}  // namespace

double metaframe_rate_hz(const SiteNodeConfig& config, const config::Rig& rig) {
    constexpr double kMostHz = 400.0;  // RecordingOptions::as_fast_as_possible
    if (config.capture.as_fast_as_possible) return kMostHz;
    return config.capture.rate_hz > 0.0 ? config.capture.rate_hz : rig.rate_hz;
}

std::string source_rate_text(const SiteNodeConfig& config, const config::Rig& rig) {
    if (config.capture.as_fast_as_possible) return "unpaced";
    const bool is_recorded_rate =
        config.capture.source == "recording" && config.capture.rate_hz <= 0.0;
    return fmt::format("{:g}",
                       metaframe_rate_hz(config, rig) /
                           (is_recorded_rate ? static_cast<double>(config.capture.every) : 1.0));
}

Expected<std::unique_ptr<capture::FrameSource>> open_frame_source(const SiteNodeConfig& config,
                                                                  std::stop_token stop) {
    if (auto checked = check(config); !checked) return tl::unexpected(checked.error());
    if (auto found = check_places(config); !found) return tl::unexpected(found.error());
    const auto rig = load_checked_rig(config);
    if (!rig) return tl::unexpected(rig.error());
    return open_source(config.capture, config.simulation, stop);
}

Expected<void> learn_background(const SiteNodeConfig& config, std::stop_token stop) {
    auto source = open_frame_source(config, stop);
    if (!source) return tl::unexpected(source.error());
    return learn_backgrounds(
        **source, config.pipeline.background, config.pipeline.segmentation, stop);
}

Expected<void> check_files(const SiteNodeConfig& config) {
    const auto rig = load_checked_description(config);
    if (!rig) return tl::unexpected(rig.error());
    if (is_region_host(config)) return {};
    if (auto fits = check(config, *rig); !fits) return fits;
    return check_own_part(config);
}

Expected<std::unique_ptr<SiteNode>> SiteNode::create(const SiteNodeConfig& asked,
                                                     std::stop_token stop) {
    const auto rig = load_checked_description(asked);
    if (!rig) return tl::unexpected(rig.error());
    SiteNodeConfig config = asked;
    if (config.threads == 0) config.threads = default_threads();
    take_bounds(*rig, config.pipeline.hull);
    if (auto fits = check(config, *rig); !fits) return tl::unexpected(fits.error());
    if (auto fits = check_own_part(config); !fits) return tl::unexpected(fits.error());
    for (RegionOptions& region : config.pipeline.hull.regions)
        region.is_elsewhere = hosts::host_of_region(config.hosts, region.name) != nullptr;
    const auto hull = HullStage::create(
        rig->cameras, config.pipeline.hull, config.pipeline.silhouette.tolerance_px);
    if (!hull) return tl::unexpected(hull.error());
    // before the slow opening and learning of the room: reports a network or name problem at once
    auto participant = bus::Participant::create(config.bus);
    if (!participant) return tl::unexpected(participant.error());
    const auto run_control = std::make_shared<RunControl>();
    auto member = presence::join_world(
        *participant,
        bus::ProgramKind::kSiteNode,
        config.name,
        [run_control](const Error& lost) { run_control->lose_name(lost); },
        stop);
    if (!member) return tl::unexpected(member.error());

    hosts::HostsSource* hosts = nullptr;
    auto source = open_frames(config, *rig, *participant, hosts, stop);
    if (!source) return tl::unexpected(source.error());
    app::log::info("source opened kind={} cameras={} rate_hz={}",
                   hosts == nullptr ? config.capture.source : "camera nodes",
                   (*source)->rig().cameras.size(),
                   source_rate_text(config, (*source)->rig()));
    auto region_hosts = open_region_hosts(config, *rig, *hull, *participant);
    if (!region_hosts) return tl::unexpected(region_hosts.error());
    auto pipeline = Pipeline::create(**source, config.pipeline, stop);
    if (!pipeline) return tl::unexpected(pipeline.error());
    for (const std::string& name : pipeline->cameras_without_background()) {
        app::log::warn("camera '{}' is excluded: it did not show the empty room at the start",
                       name);
    }

    std::optional<bus::Writer<bus::SiteDescription>> description;
    std::optional<bus::Writer<bus::SiteMesh>> mesh;
    std::optional<bus::Writer<bus::SiteStatus>> status;
    auto textures = open_textures(*participant, (*source)->rig().cameras.size());
    if (!textures) return tl::unexpected(textures.error());
    auto feedback = bus::Reader<bus::StreamFeedback>::create(*participant);
    if (!feedback) return tl::unexpected(feedback.error());
    for (const auto& opened :
         {open(*participant, description), open(*participant, mesh), open(*participant, status)}) {
        if (!opened) return tl::unexpected(opened.error());
    }
    Writers writers{
        std::move(*description), std::move(*mesh), std::move(*textures), std::move(*status)};
    std::unique_ptr<SiteNode> node(new SiteNode(config,
                                                std::move(*source),
                                                std::move(*pipeline),
                                                std::move(writers),
                                                std::move(*feedback),
                                                run_control,
                                                std::move(*member),
                                                hosts,
                                                std::move(*region_hosts)));
    if (auto opened = node->open_recorder(*participant); !opened)
        return tl::unexpected(opened.error());
    return node;
}

Expected<void> SiteNode::open_recorder(const bus::Participant& participant) {
    if (!may_record(config_)) return {};
    if (source_->has_silhouettes()) {
        return make_error(
            ErrorKind::kConfiguration,
            "--record: this recording has masks of another tool, which cannot be recorded again: "
            "copy its folder");
    }
    record::RecordedRoom room{config_.name, source_->rig(), {}, config_.settings};
    if (config_.capture.rate_hz > 0.0) room.rig.rate_hz = config_.capture.rate_hz;
    for (std::size_t i = 0; i < room.rig.cameras.size(); ++i)
        room.rooms.push_back(pipeline_.room(i));
    auto recorder =
        record::RawRecorder::create(std::move(room),
                                    recorder_options(config_.record,
                                                     config_.capture,
                                                     source_->rig(),
                                                     metaframe_rate_hz(config_, source_->rig())));
    if (!recorder) return tl::unexpected(recorder.error());
    recorder_ = std::move(*recorder);
    if (config_.record.orders.empty()) return {};
    auto orders =
        RecordOrders::create(participant, config_.name, config_.record.orders, *recorder_);
    if (!orders) return tl::unexpected(orders.error());
    record_orders_ = std::move(*orders);
    return {};
}

SiteNode::SiteNode(const SiteNodeConfig& config,
                   std::unique_ptr<capture::FrameSource> source,
                   Pipeline pipeline,
                   Writers writers,
                   bus::Reader<bus::StreamFeedback> feedback,
                   std::shared_ptr<RunControl> run_control,
                   std::unique_ptr<presence::Membership> membership,
                   hosts::HostsSource* hosts,
                   std::unique_ptr<hosts::RegionHosts> region_hosts)
    : config_(config),
      source_(std::move(source)),
      hosts_(hosts),
      region_hosts_(std::move(region_hosts)),
      pipeline_(std::move(pipeline)),
      writers_(std::move(writers)),
      stream_(config_.stream,
              config_.pipeline.jpeg_quality,
              metaframe_rate_hz(config_, source_->rig()),
              config_.name,
              std::move(feedback)),
      pool_(static_cast<std::size_t>(config.threads)),
      offsets_(source_->rig(), source_->is_live()),
      rig_watcher_(agreement_options(config_.pipeline.hull, pipeline_)),
      coherence_watcher_(source_->rig().cameras,
                         metaframe_rate_hz(config_, source_->rig()),
                         rig_file(config_),
                         config_.kept_silhouettes.empty() ? std::filesystem::path()
                                                          : config_.kept_silhouettes / config_.name,
                         [this] { return rig_watcher_.is_explained(); }),
      run_control_(std::move(run_control)),
      membership_(std::move(membership)) {
    pipeline_.set_remote_regions(region_hosts_.get());
    if (hosts_ != nullptr) hosts_->set_wishes({.jpeg_quality = config_.pipeline.jpeg_quality});
    if (config_.preview.empty()) return;
    std::vector<std::string> names;
    for (const auto& camera : source_->rig().cameras) names.push_back(camera.name);
    preview_ = std::make_unique<preview::Preview>(config_.preview, std::move(names));
}

}  // namespace atrium::site_node
