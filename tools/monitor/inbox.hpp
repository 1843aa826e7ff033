#pragma once

#include "core/base/expected.hpp"
#include "core/bus/bus.hpp"
#include "tools/monitor/world_model.hpp"

#include <optional>

namespace atrium::monitor {

/// Reads the topics of a world for the monitor. Writes nothing and has no Presence, so no program
/// waits for it, checks its name, or sends it a stream that it does not measure.
class Inbox {
public:
    /// `measure`: also subscribes to the streams; every writer then sends them to this host too.
    static Expected<Inbox> create(const bus::BusOptions& options, bool measure);

    const bus::Participant& participant() const { return participant_; }
    /// Waits for samples. Returns false after the timeout or `wake`.
    bool wait(std::chrono::milliseconds timeout) { return waiter_.wait(timeout); }
    void wake() { waiter_.wake(); }
    /// Passes the new samples to the model. Never blocks.
    void take(WorldModel& model);

private:
    struct Streams {
        bus::Reader<bus::SiteMesh> meshes;
        bus::Reader<bus::CameraTexture> textures;
        bus::Reader<bus::SceneState> states;
    };
    Inbox(bus::Participant participant,
          bus::Waiter waiter,
          bus::Reader<bus::Presence> presences,
          bus::Reader<bus::SiteStatus> sites,
          bus::Reader<bus::WorldStatus> worlds,
          bus::Reader<bus::ViewerStatus> viewers,
          bus::Reader<bus::CameraNodeStatus> camera_nodes,
          bus::Reader<bus::RegionNodeStatus> region_nodes,
          bus::Reader<bus::StreamFeedback> feedback);
    Expected<void> subscribe_to_streams();
    void take_streams(WorldModel& model, WorldModel::Clock::time_point now);

    bus::Participant participant_;
    bus::Waiter waiter_;
    bus::Reader<bus::Presence> presences_;
    bus::Reader<bus::SiteStatus> sites_;
    bus::Reader<bus::WorldStatus> worlds_;
    bus::Reader<bus::ViewerStatus> viewers_;
    bus::Reader<bus::CameraNodeStatus> camera_nodes_;
    bus::Reader<bus::RegionNodeStatus> region_nodes_;
    bus::Reader<bus::StreamFeedback> feedback_;
    std::optional<Streams> streams_;
};

}  // namespace atrium::monitor
