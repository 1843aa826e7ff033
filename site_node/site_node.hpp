#pragma once

#include "core/app/lasting_log.hpp"
#include "core/app/log.hpp"
#include "core/base/expected.hpp"
#include "core/base/latest_slot.hpp"
#include "core/base/processor_use.hpp"
#include "core/base/statistics.hpp"
#include "core/base/thread_pool.hpp"
#include "core/base/two_stage_order.hpp"
#include "core/bus/bus.hpp"
#include "core/presence/membership.hpp"
#include "site_node/camera_status.hpp"
#include "site_node/capture/timed_assembler.hpp"
#include "site_node/coherence_watcher.hpp"
#include "site_node/config.hpp"
#include "site_node/hosts/hosts_source.hpp"
#include "site_node/hosts/region_hosts.hpp"
#include "site_node/lock_step.hpp"
#include "site_node/preview/preview.hpp"
#include "site_node/record/raw_recorder.hpp"
#include "site_node/record_orders.hpp"
#include "site_node/refinement_pause.hpp"
#include "site_node/rig_watcher.hpp"
#include "site_node/run_control.hpp"
#include "site_node/stage_times.hpp"
#include "site_node/stream_adapter.hpp"

#include <atomic>
#include <memory>
#include <mutex>
#include <stop_token>
#include <string>
#include <vector>

namespace atrium::site_node {

/// Metaframes per second that the configuration or else the rig asks for.
double metaframe_rate_hz(const SiteNodeConfig& config, const config::Rig& rig);

/// The same as text for the log: "15", or "unpaced" for a recording as fast as possible. Of every
/// Nth picture, `capture.every`, an Nth of the recorded rate.
std::string source_rate_text(const SiteNodeConfig& config, const config::Rig& rig);

/// Checks the configuration and opens the frame source. A simulated room may take minutes.
Expected<std::unique_ptr<capture::FrameSource>> open_frame_source(const SiteNodeConfig& config,
                                                                  std::stop_token stop);

/// Learns the empty room of all cameras and writes it to segmentation.background_folder, instead of
/// a run.
Expected<void> learn_background(const SiteNodeConfig& config, std::stop_token stop);

/// Finds everything that a start would refuse, in the configuration and in the files that it names.
/// Opens no source.
Expected<void> check_files(const SiteNodeConfig& config);

/// One room: captures, computes, publishes. `create` does everything that can fail (recording,
/// rendering of a simulated room, background, bus); `run` owns the threads.
class SiteNode {
public:
    static Expected<std::unique_ptr<SiteNode>> create(const SiteNodeConfig& asked,
                                                      std::stop_token stop);

    /// Runs until the stop, the end of the source or `site.seconds`. One caller at a time. Error
    /// kInvalidData with the likely cause if pictures came, but nothing could be published.
    Expected<void> run(std::stop_token stop);

    /// Thread-safe.
    bus::SiteStatus status() const;

    /// Starts and stops recordings of the cameras; null: nothing is recorded and there is no
    /// pre-roll.
    record::RawRecorder* recorder() { return recorder_.get(); }

private:
    struct Writers {
        bus::Writer<bus::SiteDescription> description;
        bus::Writer<bus::SiteMesh> mesh;
        // One per camera: Cyclone DDS repairs only one fragmented sample per writer and round trip.
        std::vector<bus::Writer<bus::CameraTexture>> textures;
        bus::Writer<bus::SiteStatus> status;
    };

    SiteNode(const SiteNodeConfig& config,
             std::unique_ptr<capture::FrameSource> source,
             Pipeline pipeline,
             Writers writers,
             bus::Reader<bus::StreamFeedback> feedback,
             std::shared_ptr<RunControl> run_control,
             std::unique_ptr<presence::Membership> membership,
             hosts::HostsSource* hosts,
             std::unique_ptr<hosts::RegionHosts> region_hosts);

    Expected<void> open_recorder(const bus::Participant& participant);
    void capture_metaframes(std::stop_token stop);
    void hand_over(capture::Metaframe metaframe);
    // One metaframe between the two stages of the pipeline.
    struct Ready {
        std::unique_ptr<Pipeline::Silhouettes> silhouettes;
        StreamAdapter::Choice choice;
        ThreadPool::Priority priority;  // over the silhouettes of the next metaframe
    };
    void find_silhouettes(std::stop_token stop);
    void find_silhouettes_of(const capture::Metaframe& metaframe,
                             const StreamAdapter::Choice& choice,
                             std::unique_ptr<Pipeline::Silhouettes> memory);
    void compute_frames(std::stop_token stop);
    void compute_frame(Ready& ready);
    void count_failure(std::uint64_t frame_id, const Error& error);
    void count_losses(const SiteFrame& frame);
    /// Warns, once, that this many metaframes were published and none has a person.
    void warn_of_nobody(std::uint64_t num_metaframes);
    Expected<void> explain_no_output(const bus::SiteStatus& total, bool was_stopped);
    void show_preview(const Pipeline::Silhouettes& silhouettes);
    void publish_frames(std::stop_token stop);
    void report_status(std::stop_token stop);
    void look_at_refinement(const bus::SiteStatus& now);
    static void name_remote_textures(const SiteFrame& frame, bus::SiteMesh& mesh);
    Expected<std::size_t> publish(SiteFrame& frame);

    SiteNodeConfig config_;
    std::unique_ptr<capture::FrameSource> source_;
    hosts::HostsSource* hosts_;  // is `source_`; null: this process has the cameras
    std::unique_ptr<hosts::RegionHosts> region_hosts_;  // null: this process computes all regions
    Pipeline pipeline_;
    Writers writers_;
    StreamAdapter stream_;
    ThreadPool pool_;
    std::unique_ptr<preview::Preview> preview_;      // null: no preview
    std::unique_ptr<record::RawRecorder> recorder_;  // reads the rooms of `pipeline_`
    std::unique_ptr<RecordOrders> record_orders_;    // null: it takes none

    Timestamp last_sent_;  // capture time; of the silhouettes' thread

    // newest wins: a late metaframe is useless
    TwoStageOrder<capture::Metaframe, Ready> metaframes_;
    LockStep lock_step_;  // for a recording that is played as fast as possible
    LatestSlot<std::unique_ptr<Pipeline::Silhouettes>> spare_silhouettes_;
    LatestSlot<std::unique_ptr<SiteFrame>>
        site_frames_;  // newest wins: a slow link costs frames, not latency
    LatestSlot<std::unique_ptr<SiteFrame>> spare_frames_;  // buffers for reuse

    std::atomic<std::uint64_t> num_captured_{0};
    std::atomic<std::uint64_t> num_incomplete_{0};
    std::atomic<std::uint64_t> num_incomplete_used_{0};
    std::atomic<std::uint64_t> num_failed_{0};
    std::atomic<std::uint64_t> num_published_{0};
    std::atomic<std::uint64_t> num_with_people_{0};  // published with a hull
    std::atomic<bool> told_nobody_ = false;
    std::atomic<std::uint64_t> num_bytes_{0};
    OffsetBoard offsets_;
    RigWatcher rig_watcher_;
    CoherenceWatcher coherence_watcher_;
    mutable std::mutex losses_mutex_;
    bus::LeftOutTotals losses_;
    std::string last_failure_;  // why the newest failed metaframe failed
    StageTimes stage_times_;
    RateMeter published_rate_;
    RateMeter bytes_rate_;
    RefinementPause refinement_pause_;  // of the reporting thread
    std::atomic<bool> is_refinement_paused_{false};
    std::atomic<double> metaframes_per_s_{0.0};
    std::atomic<double> bytes_per_s_{0.0};
    std::atomic<double> first_output_s_{0.0};  // 0: nothing published yet
    ProcessorMeter processor_meter_;           // of the reporting thread
    mutable std::mutex processor_mutex_;
    ProcessorUse processor_;  // latest measurement
    app::log::OncePerSecond complaints_;
    app::log::LastingLog missing_cameras_;
    app::log::LastingLog missing_regions_;
    app::log::LastingLog failures_;

    std::shared_ptr<RunControl> run_control_;  // shared with the membership, which exists first
    std::unique_ptr<presence::Membership> membership_;
};

}  // namespace atrium::site_node
