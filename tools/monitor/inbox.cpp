#include "tools/monitor/inbox.hpp"

#include "core/bus/names.hpp"

#include <utility>

namespace atrium::monitor {
namespace {

using bus::ProgramKind;

template <typename... Results>
const Error* first_error(const Results&... results) {
    const Error* first = nullptr;
    ((first = first == nullptr && !results ? &results.error() : first), ...);
    return first;
}

}  // namespace

Inbox::Inbox(bus::Participant participant,
             bus::Waiter waiter,
             bus::Reader<bus::Presence> presences,
             bus::Reader<bus::SiteStatus> sites,
             bus::Reader<bus::WorldStatus> worlds,
             bus::Reader<bus::ViewerStatus> viewers,
             bus::Reader<bus::CameraNodeStatus> camera_nodes,
             bus::Reader<bus::RegionNodeStatus> region_nodes,
             bus::Reader<bus::StreamFeedback> feedback)
    : participant_(std::move(participant)),
      waiter_(std::move(waiter)),
      presences_(std::move(presences)),
      sites_(std::move(sites)),
      worlds_(std::move(worlds)),
      viewers_(std::move(viewers)),
      camera_nodes_(std::move(camera_nodes)),
      region_nodes_(std::move(region_nodes)),
      feedback_(std::move(feedback)) {
    waiter_.add(presences_);
    waiter_.add(sites_);
    waiter_.add(worlds_);
    waiter_.add(viewers_);
    waiter_.add(camera_nodes_);
    waiter_.add(region_nodes_);
    waiter_.add(feedback_);
}

Expected<Inbox> Inbox::create(const bus::BusOptions& options, bool measure) {
    auto participant = bus::Participant::create(options);
    if (!participant) return tl::unexpected(participant.error());
    auto waiter = bus::Waiter::create(*participant);
    auto presences = bus::Reader<bus::Presence>::create(*participant);
    auto sites = bus::Reader<bus::SiteStatus>::create(*participant);
    auto worlds = bus::Reader<bus::WorldStatus>::create(*participant);
    auto viewers = bus::Reader<bus::ViewerStatus>::create(*participant);
    auto camera_nodes = bus::Reader<bus::CameraNodeStatus>::create(*participant);
    auto region_nodes = bus::Reader<bus::RegionNodeStatus>::create(*participant);
    auto feedback = bus::Reader<bus::StreamFeedback>::create(*participant);
    const Error* error = first_error(
        waiter, presences, sites, worlds, viewers, camera_nodes, region_nodes, feedback);
    if (error != nullptr) return tl::unexpected(*error);
    Inbox inbox(std::move(*participant),
                std::move(*waiter),
                std::move(*presences),
                std::move(*sites),
                std::move(*worlds),
                std::move(*viewers),
                std::move(*camera_nodes),
                std::move(*region_nodes),
                std::move(*feedback));
    if (measure) {
        if (auto subscribed = inbox.subscribe_to_streams(); !subscribed)
            return tl::unexpected(subscribed.error());
    }
    return inbox;
}

Expected<void> Inbox::subscribe_to_streams() {
    auto meshes = bus::Reader<bus::SiteMesh>::create(participant_);
    auto textures = bus::Reader<bus::CameraTexture>::create(participant_);
    auto states = bus::Reader<bus::SceneState>::create(participant_);
    const Error* error = first_error(meshes, textures, states);
    if (error != nullptr) return tl::unexpected(*error);
    streams_.emplace(Streams{std::move(*meshes), std::move(*textures), std::move(*states)});
    waiter_.add(streams_->meshes);
    waiter_.add(streams_->textures);
    waiter_.add(streams_->states);
    return {};
}

void Inbox::take(WorldModel& model) {
    const auto now = WorldModel::Clock::now();
    // statuses first: the last status of a program comes before its end
    model.rejected(sites_.take([&](bus::SiteStatus&& status) { model.see(status, now); },
                               [&](const bus::SiteStatus& key, bus::Ending how) {
                                   model.status_gone(ProgramKind::kSiteNode, key.site, how, now);
                               }),
                   now);
    model.rejected(worlds_.take([&](bus::WorldStatus&& status) { model.see(status, now); },
                                [&](const bus::WorldStatus& key, bus::Ending how) {
                                    model.status_gone(
                                        ProgramKind::kWorldServer, key.world, how, now);
                                }),
                   now);
    model.rejected(viewers_.take([&](bus::ViewerStatus&& status) { model.see(status, now); },
                                 [&](const bus::ViewerStatus& key, bus::Ending how) {
                                     model.status_gone(ProgramKind::kViewer, key.viewer, how, now);
                                 }),
                   now);
    const auto node_gone = [&](const bus::CameraNodeStatus& key, bus::Ending how) {
        model.status_gone(
            ProgramKind::kCameraNode, bus::host_program_name(key.site, key.host), how, now);
    };
    model.rejected(camera_nodes_.take(
                       [&](bus::CameraNodeStatus&& status) { model.see(status, now); }, node_gone),
                   now);
    const auto region_gone = [&](const bus::RegionNodeStatus& key, bus::Ending how) {
        model.status_gone(
            ProgramKind::kRegionNode, bus::host_program_name(key.site, key.host), how, now);
    };
    model.rejected(
        region_nodes_.take([&](bus::RegionNodeStatus&& status) { model.see(status, now); },
                           region_gone),
        now);
    model.rejected(feedback_.take([&](bus::StreamFeedback&& sample) { model.see(sample, now); },
                                  [&](const bus::StreamFeedback& key) { model.gone(key); }),
                   now);
    model.rejected(presences_.take([&](bus::Presence&& presence) { model.see(presence, now); },
                                   [&](const bus::Presence& key, bus::Ending how) {
                                       model.gone(key, how, now);
                                   }),
                   now);
    if (streams_) take_streams(model, now);
}

void Inbox::take_streams(WorldModel& model, WorldModel::Clock::time_point now) {
    model.rejected(streams_->meshes.take([&](bus::SiteMesh&& mesh) {
        model.measured("SiteMesh", ProgramKind::kSiteNode, mesh.site, mesh.draco.size(), now);
    }),
                   now);
    model.rejected(streams_->textures.take([&](bus::CameraTexture&& texture) {
        model.measured("CameraTexture",
                       ProgramKind::kSiteNode,
                       texture.site,
                       texture.colour.size() + texture.mask.size(),
                       now);
    }),
                   now);
    // per object: number, pose and two velocities
    constexpr std::size_t kStateBytes = 4 + 13 * sizeof(double);
    model.rejected(streams_->states.take([&](bus::SceneState&& state) {
        model.measured("SceneState",
                       ProgramKind::kWorldServer,
                       state.world,
                       state.objects.size() * kStateBytes,
                       now);
    }),
                   now);
}

}  // namespace atrium::monitor
