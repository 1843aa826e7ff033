#include "tools/simulated_cameras/camera_server.hpp"

#include "core/app/log.hpp"
#include "core/base/timestamp.hpp"
#include "tools/simulated_cameras/served_camera.hpp"

#include <fmt/format.h>
#include <glib.h>

#include <cassert>
#include <optional>

namespace atrium::simulated_cameras {
namespace {

using Clock = std::chrono::steady_clock;

constexpr std::size_t kMaxSerialLength = 15;  // GigE Vision, without the terminating zero

std::chrono::nanoseconds from_ms(double ms) {
    return std::chrono::nanoseconds(static_cast<std::int64_t>(ms * 1e6));
}

Clock::duration from_s(double seconds) {
    return std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(seconds));
}

std::int64_t now_us() { return Timestamp::now().ns / 1000; }

}  // namespace

std::vector<CameraIdentity> identities_of(const config::Rig& rig) {
    std::vector<CameraIdentity> identities;
    for (std::size_t i = 0; i < rig.cameras.size(); ++i) {
        const std::string& name = rig.cameras[i].name;
        identities.push_back(
            {name,
             name.size() <= kMaxSerialLength ? name : fmt::format("simulated{}", i),
             fmt::format("127.0.0.{}", i + 2)});
    }
    return identities;
}

struct CameraServer::Impl {
    Impl(ShownPictures shown, const ServerOptions& server_options)
        : options(server_options), state(std::move(shown), options.empty_time) {
        identities = identities_of(state.shown.rig);
        state.on_picture = [this] { note_first_picture(); };
        for (std::size_t i = 0; i < identities.size(); ++i) {
            const CameraFaults faults{.lost_share = options.faults.lost_share[i],
                                      .delay = from_ms(options.faults.delay_ms[i]),
                                      .clock_offset = from_ms(options.faults.clock_offset_ms[i])};
            cameras.push_back(
                std::make_unique<ServedCamera>(i, identities[i], options.stamp, faults, state));
        }
    }

    void note_first_picture() {
        if (has_begun) return;
        {
            const std::lock_guard lock(mutex);
            if (!begin) begin = Clock::now();
            has_begun = true;
        }
        wake.notify_all();
    }

    const ServerOptions options;
    SharedServerState state;
    std::vector<CameraIdentity> identities;
    std::mutex mutex;
    std::condition_variable_any wake;
    std::optional<Clock::time_point> begin;  // time of the first picture
    std::atomic<bool> has_begun{false};
    std::vector<std::unique_ptr<ServedCamera>> cameras;  // last member: their threads use the rest
};

CameraServer::CameraServer(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
CameraServer::~CameraServer() = default;

Expected<std::unique_ptr<CameraServer>> CameraServer::start(ShownPictures shown,
                                                            const ServerOptions& options) {
    assert(options.faults.lost_share.size() == shown.rig.cameras.size());
    // Aravis uses GLib's global generator
    g_random_set_seed(static_cast<guint32>(options.seed));
    auto impl = std::make_unique<Impl>(std::move(shown), options);
    for (const auto& camera : impl->cameras) {
        if (auto started = camera->start(); !started) return tl::unexpected(started.error());
    }
    return std::unique_ptr<CameraServer>(new CameraServer(std::move(impl)));
}

void CameraServer::follow_outages(std::stop_token stop) {
    struct Event {
        double at_s = 0.0;
        std::size_t camera = 0;
        bool comes = false;
    };
    std::vector<Event> events;
    for (const Outage& outage : impl_->options.faults.outages) {
        events.push_back({outage.from_s, outage.camera, false});
        events.push_back({outage.from_s + outage.seconds, outage.camera, true});
    }
    std::stable_sort(events.begin(), events.end(), [](const Event& a, const Event& b) {
        return a.at_s < b.at_s;
    });
    std::unique_lock lock(impl_->mutex);
    if (!impl_->wake.wait(lock, stop, [this] { return impl_->begin.has_value(); })) return;
    const Clock::time_point begin = *impl_->begin;
    for (const Event& event : events) {
        impl_->wake.wait_until(lock, stop, begin + from_s(event.at_s), [] { return false; });
        if (stop.stop_requested()) return;
        lock.unlock();  // the camera's own thread may have to report its first picture
        ServedCamera& camera = *impl_->cameras[event.camera];
        if (event.comes) {
            if (auto started = camera.start(); !started)
                app::log::error("camera does not come back {}", started.error().message);
        } else {
            camera.stop();
        }
        app::log::info("camera {} camera={} at_s={:.3f}",
                       event.comes ? "is back" : "is gone",
                       camera.identity().name,
                       std::chrono::duration<double>(Clock::now() - begin).count());
        lock.lock();
    }
}

void CameraServer::empty_room() { impl_->state.schedule.empty_room(now_us()); }

std::vector<std::uint64_t> CameraServer::num_sent() const {
    std::vector<std::uint64_t> sent;
    for (const auto& camera : impl_->cameras) sent.push_back(camera->num_sent());
    return sent;
}

const std::vector<CameraIdentity>& CameraServer::identities() const { return impl_->identities; }

}  // namespace atrium::simulated_cameras
