#include "site_node/camera_node/camera_node.hpp"

#include "core/app/process.hpp"
#include "core/app/program.hpp"
#include "core/base/named_thread.hpp"
#include "core/base/next_second.hpp"
#include "core/presence/kernel_clock.hpp"
#include "core/status/bottleneck.hpp"
#include "site_node/camera_status.hpp"
#include "site_node/hosts/model_part_watch.hpp"
#include "site_node/source/open_source.hpp"

#include <fmt/format.h>

#include <charconv>
#include <condition_variable>
#include <thread>
#include <utility>

namespace atrium::camera_node {
namespace {

using Clock = std::chrono::steady_clock;

constexpr std::chrono::seconds kBetweenAttempts{1};

std::size_t index_of(const std::string& key) {
    std::size_t index = 0;
    std::from_chars(key.data(), key.data() + key.size(), index);
    return index;
}

}  // namespace

CameraNode::CameraNode(site_node::SiteNodeConfig config,
                       std::string host,
                       std::vector<std::string> camera_names,
                       std::unique_ptr<capture::FrameSource> source,
                       std::vector<std::unique_ptr<Camera>> cameras,
                       Bus bus,
                       std::unique_ptr<hosts::ClockEpoch> clock_epoch,
                       std::uint64_t source_epoch,
                       std::shared_ptr<site_node::RunControl> run_control,
                       std::unique_ptr<presence::Membership> membership,
                       std::shared_ptr<segmentation_worker::WorkerTally> worker)
    : config_(std::move(config)),
      host_(std::move(host)),
      camera_names_(std::move(camera_names)),
      source_(std::move(source)),
      cameras_(std::move(cameras)),
      bus_(std::move(bus)),
      clock_epoch_(std::move(clock_epoch)),
      source_epoch_(source_epoch),
      run_control_(std::move(run_control)),
      membership_(std::move(membership)),
      worker_(std::move(worker)),
      workers_("work",
               static_cast<std::size_t>(config_.threads),
               [this](const std::string& key, Picture picture, std::size_t /*worker*/) {
                   work_on(key, std::move(picture));
               }) {
    orders_.jpeg_quality = static_cast<std::uint32_t>(config_.pipeline.jpeg_quality);
    if (!config_.preview.empty())
        preview_ = std::make_unique<CameraPreview>(config_.preview, camera_names_);
}

CameraNode::~CameraNode() { workers_.stop(); }

Expected<void> CameraNode::run(std::stop_token stop) {
    if (auto begun = run_control_->begin(); !begun) return begun;
    const std::stop_callback pass_on(stop, [this] { run_control_->finish({}); });
    {
        const std::jthread orders =
            named_thread("orders", [this](std::stop_token s) { follow_orders(std::move(s)); });
        const std::jthread capturer =
            named_thread("capture", [this](std::stop_token) { capture(run_control_->token()); });
        report_status(run_control_->token());
    }
    workers_.stop();
    const bus::CameraNodeStatus total = status();
    app::log::info("stopped pictures={} silhouettes={} textures={} late={} failed={} {}",
                   total.num_pictures,
                   total.num_silhouettes,
                   total.num_textures,
                   total.num_dropped_late,
                   total.num_failed,
                   atrium::status::process_fields(total.processor, total.first_output_s));
    for (const capture::CameraCounters& counters : camera_counters()) {
        if (config_.capture.source == "cameras" || has_faults(counters))
            app::log::info("camera {}", to_line(counters));
    }
    if (worker_ != nullptr) app::log::info("segmentation_worker {}", worker_->line());
    return run_control_->result();
}

void CameraNode::capture(std::stop_token stop) {
    while (!stop.stop_requested()) {
        bool was_set = false;
        const auto done = capture_until_clock_is_set(stop, was_set);
        if (!was_set) return run_control_->finish(done);
        app::log::warn(
            "clock_was_set step_ms={:.1f} reason=\"the clock of this host was set: "
            "capturing begins again\"",
            milliseconds(clock_epoch_->last_step()));
        if (auto opened = open_source_anew(stop); !opened)
            return run_control_->finish(stop.stop_requested() ? Expected<void>() : opened);
    }
}

// What a source learned of the times of its cameras does not hold after the clock was set.
Expected<void> CameraNode::open_source_anew(std::stop_token stop) {
    {
        // before the new one: it would find its cameras in use
        const std::lock_guard lock(source_mutex_);
        counted_before_ = counters_so_far();
        source_.reset();
    }
    std::mutex mutex;
    std::condition_variable_any wake;
    while (true) {
        source_epoch_ = clock_epoch_->current();
        auto opened = site_node::open_aligned_source(
            config_.capture, config_.simulation, camera_names_, stop);
        if (opened) {
            const std::lock_guard lock(source_mutex_);
            source_ = std::move(*opened);
            return {};
        }
        if (opened.error().kind == ErrorKind::kConfiguration || stop.stop_requested())
            return tl::unexpected(opened.error());
        complaints_.warn("cameras are not back: " + opened.error().message);
        std::unique_lock lock(mutex);
        wake.wait_for(lock, stop, kBetweenAttempts, [] { return false; });
    }
}

Expected<void> CameraNode::capture_until_clock_is_set(std::stop_token stop, bool& was_set) {
    const std::uint64_t epoch = source_epoch_;
    std::stop_source end;
    const std::stop_callback pass_on(stop, [&] { end.request_stop(); });
    return source_->run(end.get_token(), [&](capture::CameraFrame frame) {
        if (clock_epoch_->current() != epoch) {
            was_set = true;
            end.request_stop();
            return;
        }
        if (!frame.is_lost()) ++num_pictures_;
        const std::size_t camera = frame.camera;
        const auto replaced =
            workers_.put(std::to_string(camera), Picture{std::move(frame), epoch});
        if (!replaced) return;
        if (!replaced->frame.is_lost()) ++num_dropped_;
        const std::lock_guard lock(cameras_[camera]->mutex);
        cameras_[camera]->dropped.push_back({replaced->frame.capture_time, replaced->clock_epoch});
    });
}

void CameraNode::work_on(const std::string& key, Picture picture) {
    Camera& camera = *cameras_[index_of(key)];
    std::vector<DroppedPicture> dropped;
    {
        const std::lock_guard lock(camera.mutex);
        dropped.swap(camera.dropped);
    }
    for (const auto& [time, epoch] : dropped) {
        // nobody needs to wait for them
        if (const auto lost = camera.work->publish_lost(time, epoch); !lost)
            complaints_.warn("not published: " + lost.error().message);
    }
    const bool is_lost = picture.frame.is_lost();
    const Timestamp capture_time = picture.frame.capture_time;
    if (is_lost && preview_ != nullptr)
        preview_->take(index_of(key), picture.frame, camera.work->seen());
    const auto on_silhouette = [&](std::size_t num_bytes) {
        num_silhouette_bytes_ += num_bytes;
        if (num_silhouettes_++ == 0) first_output_s_ = app::seconds_since_start();
        {
            const std::lock_guard lock(latency_mutex_);
            capture_to_silhouette_.add(Timestamp::now() - capture_time);
        }
        if (preview_ != nullptr) preview_->take(index_of(key), picture.frame, camera.work->seen());
    };
    const auto texture_bytes =
        camera.work->process(picture.frame, picture.clock_epoch, newest_orders(), on_silhouette);
    if (!texture_bytes) {
        ++num_failed_;
        complaints_.warn(fmt::format("picture failed camera={} reason=\"{}\"",
                                     camera_names_[index_of(key)],
                                     texture_bytes.error().message));
        return;
    }
    num_texture_bytes_ += *texture_bytes;
    if (*texture_bytes > 0) ++num_textures_;
}

void CameraNode::follow_orders(std::stop_token stop) {
    constexpr std::chrono::milliseconds kPatience{500};
    const std::stop_callback wake(stop, [this] { bus_.waiter.wake(); });
    while (!stop.stop_requested()) {
        bus_.waiter.wait(kPatience);
        const std::uint64_t epoch = clock_epoch_->current();
        const auto report = bus_.orders.take([&](bus::SiteOrders&& orders) {
            if (orders.site != config_.name) return;
            // not earlier: an order may come between this and the look
            answer(orders, Timestamp::now(), epoch);
            const std::lock_guard lock(orders_mutex_);
            orders_ = std::move(orders);
        });
        if (report.num_rejected > 0)
            complaints_.warn(fmt::format("orders_rejected num={} first=\"{}\"",
                                         report.num_rejected,
                                         report.first_rejection));
    }
}

void CameraNode::answer(const bus::SiteOrders& orders, Timestamp received, std::uint64_t epoch) {
    const bus::ClockAnswer answer{
        config_.name, host_, orders.number, orders.asked, received, Timestamp::now(), epoch};
    if (clock_epoch_->current() != epoch) return;  // set in between: the times do not compare
    if (const auto written = bus_.answers.write(answer); !written)
        complaints_.warn("not answered: " + written.error().message);
}

bus::SiteOrders CameraNode::newest_orders() {
    const std::lock_guard lock(orders_mutex_);
    return orders_;
}

void CameraNode::report_status(std::stop_token stop) {
    std::mutex mutex;
    std::condition_variable_any wake;
    RateMeter rate;
    RateMeter silhouette_rate;
    RateMeter texture_rate;
    atrium::status::OverloadLog overload(bus::ProgramKind::kCameraNode);
    hosts::ModelPartWatch model_part(config_.hosts, Clock::now());
    std::uint64_t last_number = 0;
    const auto begin = Clock::now();
    const auto end = begin + std::chrono::duration_cast<Clock::duration>(
                                 std::chrono::duration<double>(config_.seconds));
    while (!stop.stop_requested()) {
        auto until = next_second(begin, Clock::now());
        if (config_.seconds > 0.0) until = std::min(until, end);
        std::unique_lock lock(mutex);
        wake.wait_until(lock, stop, until, [] { return false; });
        if (config_.seconds > 0.0 && Clock::now() >= end) run_control_->finish({});
        silhouettes_per_s_ = rate.update(num_silhouettes_, Clock::now());
        silhouette_bytes_per_s_ = silhouette_rate.update(num_silhouette_bytes_, Clock::now());
        texture_bytes_per_s_ = texture_rate.update(num_texture_bytes_, Clock::now());
        {
            const std::lock_guard processor_lock(processor_mutex_);
            processor_ = processor_meter_.update();
        }
        const std::uint64_t number = newest_orders().number;
        if (const auto event =
                model_part.look(std::exchange(last_number, number) != number, Clock::now()))
            log(*event);
        const bus::CameraNodeStatus now = status();
        if (const auto written = bus_.status.write(now); !written)
            complaints_.warn(written.error().message);
        if (worker_ != nullptr) {
            worker_->look(Clock::now());
            app::log::debug("segmentation_worker {}", worker_->line());
        }
        if (const auto line = overload.look(atrium::status::figures_of(now), Clock::now()))
            app::log::warn("{}", *line);
    }
}

// Those of all cameras since the start of the program, also while the source is opened anew.
std::vector<capture::CameraCounters> CameraNode::camera_counters() const {
    const std::lock_guard lock(source_mutex_);
    return counters_so_far();
}

std::vector<capture::CameraCounters> CameraNode::counters_so_far() const {
    if (source_ == nullptr) return counted_before_;
    auto counters = source_->camera_counters();
    for (std::size_t i = 0; i < counted_before_.size(); ++i)
        counters[i] = capture::sum(counted_before_[i], counters[i]);
    return counters;
}

bus::CameraNodeStatus CameraNode::status() const {
    bus::CameraNodeStatus status;
    status.site = config_.name;
    status.host = host_;
    status.time = Timestamp::now();
    status.num_pictures = num_pictures_;
    status.num_silhouettes = num_silhouettes_;
    status.num_textures = num_textures_;
    status.num_dropped_late = num_dropped_;
    status.num_failed = num_failed_;
    status.silhouettes_per_s = silhouettes_per_s_;
    status.num_bytes_published = num_silhouette_bytes_ + num_texture_bytes_;
    status.silhouette_bytes_per_s = silhouette_bytes_per_s_;
    status.texture_bytes_per_s = texture_bytes_per_s_;
    {
        const std::lock_guard lock(latency_mutex_);
        const Quantiles q = capture_to_silhouette_.quantiles();
        status.capture_to_silhouette = {q.median_ms, q.p99_ms, q.num_samples};
    }
    status.resident_bytes = app::resident_bytes();
    for (const auto& camera : cameras_) status.camera_indices.push_back(camera->index);
    status.cameras = site_node::camera_statuses(camera_counters());
    status.first_output_s = first_output_s_;
    const presence::KernelClock clock = presence::kernel_clock();
    status.is_clock_synchronised = clock.is_synchronised;
    status.clock_max_error = clock.max_error;
    const std::lock_guard lock(processor_mutex_);
    status.processor = processor_;
    return status;
}

}  // namespace atrium::camera_node
