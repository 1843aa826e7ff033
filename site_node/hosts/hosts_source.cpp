#include "site_node/hosts/hosts_source.hpp"

#include "core/app/log.hpp"
#include "core/base/named_thread.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <condition_variable>
#include <thread>
#include <utility>

namespace atrium::hosts {
namespace {

using Clock = std::chrono::steady_clock;

constexpr std::chrono::milliseconds kBetweenOrders{100};

std::vector<std::string> camera_names(const config::Rig& rig) {
    std::vector<std::string> names;
    for (const geometry::CalibratedCamera& camera : rig.cameras) names.push_back(camera.name);
    return names;
}

HostTableOptions table_options(const config::Rig& rig, const HostsSourceOptions& options) {
    HostTableOptions table{std::chrono::nanoseconds(static_cast<std::int64_t>(1e9 / rig.rate_hz)),
                           options.deadline};
    for (const HostEntry& host : options.hosts) table.parts.push_back(part_fingerprint(rig, host));
    return table;
}

}  // namespace

Expected<std::unique_ptr<HostsSource>> HostsSource::open(const bus::Participant& participant,
                                                         const config::Rig& rig,
                                                         HostsSourceOptions options) {
    auto silhouettes = bus::Reader<bus::CameraSilhouette>::create(participant, options.site);
    if (!silhouettes) return tl::unexpected(silhouettes.error());
    auto answers = bus::Reader<bus::ClockAnswer>::create(participant, options.site);
    if (!answers) return tl::unexpected(answers.error());
    auto nodes = bus::Reader<bus::CameraNodeStatus>::create(participant);
    if (!nodes) return tl::unexpected(nodes.error());
    auto orders = bus::Writer<bus::SiteOrders>::create(participant, options.site);
    if (!orders) return tl::unexpected(orders.error());
    auto waiter = bus::Waiter::create(participant);
    if (!waiter) return tl::unexpected(waiter.error());
    waiter->add(*silhouettes);
    waiter->add(*answers);
    waiter->add(*nodes);
    return std::unique_ptr<HostsSource>(new HostsSource(rig,
                                                        std::move(options),
                                                        {std::move(*silhouettes),
                                                         std::move(*answers),
                                                         std::move(*nodes),
                                                         std::move(*orders),
                                                         std::move(*waiter)}));
}

HostsSource::HostsSource(const config::Rig& rig, HostsSourceOptions options, Bus bus)
    : rig_(rig),
      options_(std::move(options)),
      bus_(std::move(bus)),
      table_(camera_names(rig), options_.hosts, table_options(rig, options_)),
      own_epoch_(own_clock_.current()) {
    orders_.site = options_.site;
    orders_.period = table_options(rig, options_).period;
    for (const geometry::CalibratedCamera& camera : rig.cameras)
        counters_.emplace_back().name = camera.name;
}

HostsSource::~HostsSource() = default;

std::vector<Expected<void>> HostsSource::show_background(const std::vector<std::size_t>& cameras,
                                                         const BackgroundSink& /*sink*/,
                                                         std::stop_token /*stop*/) {
    const Error error{ErrorKind::kNotFound, "camera nodes learn the empty room, on their hosts"};
    return std::vector<Expected<void>>(cameras.size(), tl::unexpected(error));
}

Expected<void> HostsSource::run(std::stop_token stop, const Sink& sink) {
    const std::stop_callback wake(stop, [this] { bus_.waiter.wake(); });
    const std::jthread orders =
        named_thread("orders", [this](std::stop_token s) { give_orders(std::move(s)); });
    while (!stop.stop_requested()) {
        bus_.waiter.wait(kBetweenOrders);
        take_answers();
        take(sink);
        take_statuses();
        log_events();
    }
    return {};
}

void HostsSource::give_orders(std::stop_token stop) {
    std::mutex mutex;
    std::condition_variable_any wake;
    for (auto next = Clock::now(); !stop.stop_requested();
         next = std::max(next + kBetweenOrders, Clock::now())) {
        bus::SiteOrders orders;
        {
            const std::lock_guard lock(mutex_);
            table_.look(Clock::now());
            ++orders_.number;
            if (const std::uint64_t epoch = own_clock_.current(); epoch != own_epoch_) {
                own_epoch_ = epoch;
                first_valid_question_ = orders_.number;
                table_.forget_clocks(Clock::now());
                app::log::warn(
                    "clock_was_set step_ms={:.1f} reason=\"the clock of this host was "
                    "set: those of the others are measured anew\"",
                    milliseconds(own_clock_.last_step()));
            }
            orders_.asked = Timestamp::now();
            orders = orders_;
        }
        if (const auto written = bus_.orders.write(orders); !written)
            app::log::debug("orders are late: {}", written.error().message);
        std::unique_lock lock(mutex);
        wake.wait_until(lock, stop, next + kBetweenOrders, [] { return false; });
    }
}

void HostsSource::take_answers() {
    const auto report = bus_.answers.take([this](bus::ClockAnswer&& answer) {
        const Timestamp returned = Timestamp::now();
        if (answer.site != options_.site) return;
        const std::lock_guard lock(mutex_);
        // a question of before the clock was set, or of nobody
        if (answer.number < first_valid_question_ || answer.number > orders_.number) return;
        if (own_clock_.current() != own_epoch_) return;
        table_.add(answer, returned, Clock::now());
    });
    complain("answers_rejected", report);
}

void HostsSource::take(const Sink& sink) {
    const auto report = bus_.silhouettes.take([this](bus::CameraSilhouette&& silhouette) {
        if (silhouette.site != options_.site) return;
        const std::lock_guard lock(mutex_);
        table_.add(std::move(silhouette), Timestamp::now(), Clock::now(), frames_);
    });
    complain("silhouettes_rejected", report);
    {
        const std::lock_guard lock(mutex_);
        for (const capture::CameraFrame& frame : frames_) {
            if (!frame.is_lost()) counters_[frame.camera].last_picture = Clock::now();
        }
    }
    for (capture::CameraFrame& frame : frames_) sink(std::move(frame));
    frames_.clear();
}

void HostsSource::take_statuses() {
    const auto report = bus_.nodes.take([this](bus::CameraNodeStatus&& node) {
        if (node.site != options_.site) return;
        const std::lock_guard lock(mutex_);
        for (std::size_t i = 0; i < node.cameras.size(); ++i) {
            // each host with cameras = "auto" reports those of the others as not there
            if (!table_.has_camera(node.host, node.camera_indices[i])) continue;
            capture::CameraCounters& counters = counters_[node.camera_indices[i]];
            const bus::CameraStatus& camera = node.cameras[i];
            counters.connected = camera.connected;
            counters.num_received = camera.num_received;
            counters.num_incomplete = camera.num_incomplete;
            counters.num_resent = camera.num_resent;
            counters.num_late = camera.num_late;
            counters.num_dropped = camera.num_dropped;
            counters.num_backwards = camera.num_backwards;
            counters.num_reconnects = camera.num_reconnects;
            if (camera.last_picture_age_ms < 0.0) continue;
            const std::chrono::microseconds age(
                static_cast<std::int64_t>(1e3 * std::min(camera.last_picture_age_ms, 1e9)));
            // its silhouettes came later, if it is in use
            counters.last_picture =
                std::max(counters.last_picture.value_or(Clock::time_point{}), Clock::now() - age);
        }
    });
    complain("statuses_rejected", report);
}

void HostsSource::complain(const char* what, const bus::TakeReport& report) {
    if (report.num_rejected > 0)
        complaints_.warn(fmt::format(
            "{} num={} first=\"{}\"", what, report.num_rejected, report.first_rejection));
}

void HostsSource::log_events() {
    std::vector<HostEvent> events;
    {
        const std::lock_guard lock(mutex_);
        events = table_.take_events();
    }
    for (const HostEvent& event : events) log(event);
}

std::vector<capture::CameraCounters> HostsSource::camera_counters() const {
    const std::lock_guard lock(mutex_);
    auto counters = counters_;
    for (std::size_t i = 0; i < counters.size(); ++i)
        counters[i].connected = counters[i].connected && table_.is_in_use(i);
    return counters;
}

void HostsSource::set_wishes(const Wishes& wishes) {
    const std::lock_guard lock(mutex_);
    orders_.jpeg_quality = static_cast<std::uint32_t>(wishes.jpeg_quality);
    orders_.colour_divisor = static_cast<std::uint32_t>(wishes.colour_divisor);
    orders_.send_every = static_cast<std::uint32_t>(wishes.send_every);
    orders_.sent = wishes.sent;
}

std::vector<bus::HostStatus> HostsSource::statuses() const {
    const std::lock_guard lock(mutex_);
    return table_.statuses();
}

}  // namespace atrium::hosts
