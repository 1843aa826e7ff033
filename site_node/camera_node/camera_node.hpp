#pragma once

#include "core/app/log.hpp"
#include "core/base/expected.hpp"
#include "core/base/keyed_workers.hpp"
#include "core/base/processor_use.hpp"
#include "core/base/statistics.hpp"
#include "core/bus/bus.hpp"
#include "core/presence/membership.hpp"
#include "site_node/camera_node/camera_preview.hpp"
#include "site_node/camera_node/camera_work.hpp"
#include "site_node/config.hpp"
#include "site_node/hosts/clock_epoch.hpp"
#include "site_node/run_control.hpp"

#include <atomic>
#include <memory>
#include <mutex>
#include <stop_token>
#include <string>
#include <vector>

namespace atrium::camera_node {

/// Learns the empty room of the cameras of this host and writes it to
/// segmentation.background_folder, instead of a run.
Expected<void> learn_background(const site_node::SiteNodeConfig& config, std::stop_token stop);

/// As that of `site_node`, for this program.
Expected<void> check_files(const site_node::SiteNodeConfig& config);

/// The cameras of one host of a site: captures, segments, publishes silhouettes for the model part
/// and textures for the viewers. `create` does everything that can fail; `run` owns the threads.
class CameraNode {
public:
    static Expected<std::unique_ptr<CameraNode>> create(const site_node::SiteNodeConfig& asked,
                                                        std::stop_token stop);
    ~CameraNode();

    /// Runs until the stop or `site.seconds`. One caller at a time.
    Expected<void> run(std::stop_token stop);

    /// Thread-safe.
    bus::CameraNodeStatus status() const;

private:
    struct Bus {
        bus::Reader<bus::SiteOrders> orders;
        bus::Writer<bus::ClockAnswer> answers;
        bus::Writer<bus::CameraNodeStatus> status;
        bus::Waiter waiter;
    };
    struct DroppedPicture {
        Timestamp capture_time;
        std::uint64_t clock_epoch = 0;
    };
    struct Camera {
        std::uint32_t index = 0;  // in the rig of the site
        std::unique_ptr<CameraWork> work;
        std::mutex mutex;
        std::vector<DroppedPicture> dropped;  // replaced by the next one
    };
    struct Picture {
        capture::CameraFrame frame;
        std::uint64_t clock_epoch = 0;
    };

    CameraNode(site_node::SiteNodeConfig config,
               std::string host,
               std::vector<std::string> camera_names,
               std::unique_ptr<capture::FrameSource> source,
               std::vector<std::unique_ptr<Camera>> cameras,
               Bus bus,
               std::unique_ptr<hosts::ClockEpoch> clock_epoch,
               std::uint64_t source_epoch,
               std::shared_ptr<site_node::RunControl> run_control,
               std::unique_ptr<presence::Membership> membership,
               std::shared_ptr<segmentation_worker::WorkerTally> worker);

    void capture(std::stop_token stop);
    Expected<void> capture_until_clock_is_set(std::stop_token stop, bool& was_set);
    Expected<void> open_source_anew(std::stop_token stop);
    void work_on(const std::string& key, Picture picture);
    void follow_orders(std::stop_token stop);
    void answer(const bus::SiteOrders& orders, Timestamp received, std::uint64_t epoch);
    bus::SiteOrders newest_orders();
    void report_status(std::stop_token stop);
    std::vector<capture::CameraCounters> camera_counters() const;
    std::vector<capture::CameraCounters> counters_so_far() const;  // under source_mutex_

    site_node::SiteNodeConfig config_;
    std::string host_;
    std::vector<std::string> camera_names_;
    mutable std::mutex source_mutex_;  // guards the pointer: the source is opened anew
    std::unique_ptr<capture::FrameSource> source_;
    std::vector<capture::CameraCounters> counted_before_;  // with former sources; or empty
    std::vector<std::unique_ptr<Camera>> cameras_;
    std::unique_ptr<CameraPreview> preview_;  // null: none
    Bus bus_;
    std::unique_ptr<hosts::ClockEpoch> clock_epoch_;
    std::uint64_t source_epoch_;  // in which `source_` was opened

    std::mutex orders_mutex_;
    bus::SiteOrders orders_;
    std::atomic<std::uint64_t> num_pictures_{0};
    std::atomic<std::uint64_t> num_silhouettes_{0};
    std::atomic<std::uint64_t> num_textures_{0};
    std::atomic<std::uint64_t> num_dropped_{0};
    std::atomic<std::uint64_t> num_failed_{0};
    std::atomic<std::uint64_t> num_silhouette_bytes_{0};
    std::atomic<std::uint64_t> num_texture_bytes_{0};
    std::atomic<double> silhouettes_per_s_{0.0};
    std::atomic<double> silhouette_bytes_per_s_{0.0};
    std::atomic<double> texture_bytes_per_s_{0.0};
    std::atomic<double> first_output_s_{0.0};
    mutable std::mutex latency_mutex_;
    LatencyWindow capture_to_silhouette_;
    ProcessorMeter processor_meter_;  // of the reporting thread
    mutable std::mutex processor_mutex_;
    ProcessorUse processor_;
    app::log::OncePerSecond complaints_;

    std::shared_ptr<site_node::RunControl> run_control_;  // shared with the membership
    std::unique_ptr<presence::Membership> membership_;
    std::shared_ptr<segmentation_worker::WorkerTally> worker_;  // null: none is used
    KeyedWorkers<Picture> workers_;                             // last member: it uses all others
};

}  // namespace atrium::camera_node
