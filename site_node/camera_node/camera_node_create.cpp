#include "core/bus/names.hpp"
#include "core/presence/join_world.hpp"
#include "site_node/camera_node/camera_node.hpp"
#include "site_node/source/open_source.hpp"
#include "site_node/start_check.hpp"

#include <fmt/format.h>

#include <algorithm>

// Start of a camera node: everything that can fail.
namespace atrium::camera_node {
namespace {

using site_node::SiteNodeConfig;

// The rig's index of each camera of the source.
std::vector<std::uint32_t> indices_in(const config::Rig& rig, const config::Rig& of_source) {
    std::vector<std::uint32_t> indices;
    for (const geometry::CalibratedCamera& camera : of_source.cameras) {
        const auto found =
            std::ranges::find(rig.cameras, camera.name, &geometry::CalibratedCamera::name);
        indices.push_back(static_cast<std::uint32_t>(found - rig.cameras.begin()));
    }
    return indices;
}

// Empty: the camera does not show the empty room now.
using Stages = std::vector<std::optional<site_node::SilhouetteStage>>;

Expected<Stages> make_stages(capture::FrameSource& source,
                             const SiteNodeConfig& config,
                             bool shares_cameras,
                             std::shared_ptr<segmentation_worker::WorkerTally> worker,
                             std::stop_token stop) {
    Stages stages;
    const auto& cameras = source.rig().cameras;
    if (source.has_silhouettes()) {
        for (const geometry::CalibratedCamera& camera : cameras)
            stages.emplace_back(std::in_place, camera, config.pipeline);
        return stages;
    }
    auto made = site_node::make_silhouette_stages(
        source, site_node::all_cameras(source), config.pipeline, stop, std::move(worker));
    std::size_t num_there = 0;
    for (std::size_t i = 0; i < made.size(); ++i) {
        if (made[i]) {
            ++num_there;
            stages.emplace_back(std::move(*made[i]));
            continue;
        }
        if (made[i].error().kind != ErrorKind::kUnavailable || stop.stop_requested())
            return make_error(
                made[i].error().kind,
                fmt::format("camera '{}': {}", cameras[i].name, made[i].error().message));
        stages.emplace_back();
        if (shares_cameras)
            app::log::info("camera '{}' does not answer here", cameras[i].name);
        else
            app::log::warn("camera '{}' is excluded: it did not show the empty room at the start",
                           cameras[i].name);
    }
    if (num_there == 0)
        return make_error(ErrorKind::kUnavailable, "no camera of this host shows the empty room");
    return stages;
}

Expected<CameraWork::Writers> open_writers(const bus::Participant& participant,
                                           const std::string& site) {
    auto silhouettes = bus::Writer<bus::CameraSilhouette>::create(participant, site);
    if (!silhouettes) return tl::unexpected(silhouettes.error());
    auto textures = bus::Writer<bus::CameraTexture>::create(participant);
    if (!textures) return tl::unexpected(textures.error());
    return CameraWork::Writers{std::move(*silhouettes), std::move(*textures)};
}

// What this host has to do.
struct Part {
    config::Rig rig;  // of the whole site
    std::string host;
    std::vector<std::string> cameras;
    bool shares_cameras = false;  // with other hosts: some of them hang there
    std::uint64_t fingerprint = 0;
};

Expected<Part> own_part(const SiteNodeConfig& config) {
    const auto wrong = [](std::string text) {
        return make_error(ErrorKind::kConfiguration, std::move(text));
    };
    if (config.hosts.empty())
        return wrong(
            "host: the site's file has no [[host]]: the site is one process, site_node "
            "(docs/site_hosts.md)");
    if (!config.write_silhouettes.empty())
        return wrong("--write-silhouettes: site_node has it, in a site of one process");
    auto rig = load_checked_description(config);
    if (!rig) return tl::unexpected(rig.error());
    const std::string name = site_node::own_host(config);
    const auto host = hosts::find_host(config.hosts, name);
    if (!host) return tl::unexpected(host.error());
    auto cameras = hosts::cameras_of(*host, config.hosts, *rig);
    if (cameras.empty())
        return wrong(
            fmt::format("{}: host: '{}' has no cameras: run site_node there", host->place, name));
    const bool shares = host->takes_any && !hosts::hosts_that_share(config.hosts).empty();
    const std::uint64_t fingerprint = hosts::part_fingerprint(*rig, *host);
    return Part{std::move(*rig), name, std::move(cameras), shares, fingerprint};
}

}  // namespace

Expected<void> check_files(const SiteNodeConfig& config) {
    const auto part = own_part(config);
    return part ? Expected<void>() : tl::unexpected(part.error());
}

Expected<void> learn_background(const SiteNodeConfig& config, std::stop_token stop) {
    const auto part = own_part(config);
    if (!part) return tl::unexpected(part.error());
    auto source =
        site_node::open_aligned_source(config.capture, config.simulation, part->cameras, stop);
    if (!source) return tl::unexpected(source.error());
    return site_node::learn_backgrounds(
        **source, config.pipeline.background, config.pipeline.segmentation, stop);
}

Expected<std::unique_ptr<CameraNode>> CameraNode::create(const SiteNodeConfig& asked,
                                                         std::stop_token stop) {
    const auto part = own_part(asked);
    if (!part) return tl::unexpected(part.error());
    const auto& [rig, name, names, shares_cameras, part_fingerprint] = *part;
    SiteNodeConfig config = asked;
    if (config.threads == 0) config.threads = site_node::default_threads();

    auto participant = bus::Participant::create(config.bus);
    if (!participant) return tl::unexpected(participant.error());
    const auto run_control = std::make_shared<site_node::RunControl>();
    auto member = presence::join_world(
        *participant,
        bus::ProgramKind::kCameraNode,
        bus::host_program_name(config.name, name),
        [run_control](const Error& lost) { run_control->lose_name(lost); },
        stop);
    if (!member) return tl::unexpected(member.error());

    // before it learns the times of the cameras: the clock may be set meanwhile
    auto clock_epoch = std::make_unique<hosts::ClockEpoch>();
    const std::uint64_t source_epoch = clock_epoch->current();
    auto source = site_node::open_aligned_source(config.capture, config.simulation, names, stop);
    if (!source) return tl::unexpected(source.error());
    const double rate_hz =
        config.capture.rate_hz > 0.0 ? config.capture.rate_hz : (*source)->rig().rate_hz;
    app::log::info("source opened kind={} host={} cameras=\"{}\" rate_hz={:g}",
                   config.capture.source,
                   name,
                   fmt::join(names, " "),
                   rate_hz);
    const segmentation_worker::WorkerOptions& asked_worker = config.pipeline.worker;
    const auto worker =
        asked_worker.socket.empty()
            ? nullptr
            : std::make_shared<segmentation_worker::WorkerTally>(asked_worker.deadline_ms);
    auto stages = make_stages(**source, config, shares_cameras, worker, stop);
    if (!stages) return tl::unexpected(stages.error());

    const std::vector<std::uint32_t> indices = indices_in(rig, (*source)->rig());
    std::vector<std::unique_ptr<Camera>> cameras;
    for (std::size_t i = 0; i < indices.size(); ++i) {
        // One per camera: Cyclone DDS repairs only one fragmented sample per writer and round trip.
        auto writers = open_writers(*participant, config.name);
        if (!writers) return tl::unexpected(writers.error());
        auto camera = std::make_unique<Camera>();
        camera->index = indices[i];
        camera->work = std::make_unique<CameraWork>(config.name,
                                                    name,
                                                    indices[i],
                                                    part_fingerprint,
                                                    std::move((*stages)[i]),
                                                    config.pipeline.texture,
                                                    std::move(*writers));
        cameras.push_back(std::move(camera));
    }
    auto orders = bus::Reader<bus::SiteOrders>::create(*participant, config.name);
    if (!orders) return tl::unexpected(orders.error());
    auto answers = bus::Writer<bus::ClockAnswer>::create(*participant, config.name);
    if (!answers) return tl::unexpected(answers.error());
    auto status = bus::Writer<bus::CameraNodeStatus>::create(*participant);
    if (!status) return tl::unexpected(status.error());
    auto waiter = bus::Waiter::create(*participant);
    if (!waiter) return tl::unexpected(waiter.error());
    waiter->add(*orders);
    // in the order of the source, which may be another than that of the file
    std::vector<std::string> own_names;
    for (const auto& camera : (*source)->rig().cameras) own_names.push_back(camera.name);
    return std::unique_ptr<CameraNode>(new CameraNode(
        config,
        name,
        std::move(own_names),
        std::move(*source),
        std::move(cameras),
        {std::move(*orders), std::move(*answers), std::move(*status), std::move(*waiter)},
        std::move(clock_epoch),
        source_epoch,
        run_control,
        std::move(*member),
        worker));
}

}  // namespace atrium::camera_node
