#include "site_node/capture/aravis_source.hpp"

#include "site_node/capture/aravis_camera.hpp"
#include "site_node/capture/network_interface.hpp"
#include "site_node/capture/pace.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace atrium::capture {
namespace {

// Returns the entries in rig order.
Expected<std::vector<CameraEntry>> in_rig_order(const config::Rig& rig,
                                                const std::vector<CameraEntry>& entries) {
    const auto wrong = [](std::string text) {
        return make_error(ErrorKind::kConfiguration, "capture.camera: " + std::move(text));
    };
    std::vector<CameraEntry> ordered;
    for (const geometry::CalibratedCamera& camera : rig.cameras) {
        const auto is_it = [&](const CameraEntry& entry) { return entry.name == camera.name; };
        const auto entry = std::find_if(entries.begin(), entries.end(), is_it);
        if (entry == entries.end())
            return wrong(fmt::format("none is named '{}', a camera of the rig", camera.name));
        if (std::find_if(entry + 1, entries.end(), is_it) != entries.end())
            return wrong(fmt::format("two are named '{}'", camera.name));
        ordered.push_back(*entry);
    }
    for (const CameraEntry& entry : entries) {
        const auto is_it = [&](const CameraEntry& other) { return other.name == entry.name; };
        if (std::find_if(ordered.begin(), ordered.end(), is_it) == ordered.end())
            return wrong(fmt::format("the rig has no camera '{}'", entry.name));
    }
    return ordered;
}

void report_sockets(const CamerasOptions& options,
                    const config::Rig& rig,
                    const CameraEventSink& report) {
    if (options.use_packet_socket && may_use_packet_sockets()) return;
    std::uint64_t largest = 0;
    for (const geometry::CalibratedCamera& camera : rig.cameras) {
        largest = std::max(largest,
                           static_cast<std::uint64_t>(camera.intrinsics.width) *
                               static_cast<std::uint64_t>(camera.intrinsics.height));
    }
    const std::uint64_t allowed = max_socket_buffer_bytes();
    report({false,
            "GigE Vision pictures come through normal sockets, which lose more of them under load: "
            "packet sockets are disabled or not permitted (cap_net_raw, see atrium doctor)"});
    if (allowed == 0 || allowed >= 2 * largest) return;
    report({true,
            fmt::format("socket buffers hold {} bytes, less than two pictures: raise them with "
                        "sysctl net.core.rmem_max={} (atrium doctor)",
                        allowed,
                        2 * largest)});
}

Expected<void> too_few_pictures(std::size_t num_shown) {
    return make_error(ErrorKind::kUnavailable,
                      fmt::format("only {} pictures of the empty room arrived", num_shown));
}

}  // namespace

struct AravisSource::Cameras {
    SharedCameraState shared_state;
    std::vector<std::unique_ptr<AravisCamera>> cameras;  // in rig order
    std::vector<std::uint64_t> num_too_old;              // scratch
    std::jthread trigger;                                // last member: it uses all others

    Cameras(const CamerasOptions& options, const config::Rig& rig, CameraEventSink report)
        : shared_state(options, rig.cameras.size(), rig.rate_hz, std::move(report)),
          num_too_old(rig.cameras.size(), 0) {}

    // all at once: each may take a while to disconnect
    ~Cameras() {
        for (const auto& camera : cameras) camera->request_stop();
    }

    void run_trigger_beat(std::stop_token stop) {
        pthread_setname_np(pthread_self(), "trigger");
        Pace pace(
            shared_state.period(),
            shared_state.options.is_trigger_aligned ? Pace::Phase::kAligned : Pace::Phase::kFree);
        while (pace.wait(stop)) {
            // a late beat would be confused with the next one
            if (Pace::Clock::now() - pace.due() > shared_state.period() / 4) continue;
            for (const auto& camera : cameras) camera->fire(pace.due());
        }
    }

    // Returns an error if too few cameras connect or one refuses its settings.
    Expected<void> wait_for_enough(std::stop_token stop) {
        std::string missing;
        std::size_t num_there = 0;
        for (const auto& camera : cameras) {
            const auto connected = camera->wait_for_first_attempt(stop);
            if (connected) {
                ++num_there;
                continue;
            }
            const std::string line =
                fmt::format("camera '{}': {}", camera->name(), connected.error().message);
            if (connected.error().kind == ErrorKind::kConfiguration || stop.stop_requested())
                return make_error(connected.error().kind, line);
            missing += (missing.empty() ? "" : "; ") + line;
        }
        const std::size_t needed = shared_state.options.min_cameras == 0
                                       ? cameras.size()
                                       : shared_state.options.min_cameras;
        if (num_there >= needed) return {};
        return make_error(ErrorKind::kNotFound,
                          fmt::format("{} of {} cameras are there, {} are needed: {}",
                                      num_there,
                                      cameras.size(),
                                      needed,
                                      missing));
    }
};

AravisSource::AravisSource(const config::Rig& rig, std::unique_ptr<Cameras> cameras)
    : rig_(rig), cameras_(std::move(cameras)) {}

AravisSource::~AravisSource() = default;

Expected<std::unique_ptr<AravisSource>> AravisSource::open(const config::Rig& rig,
                                                           const CamerasOptions& options,
                                                           EventSink events,
                                                           std::stop_token stop) {
    auto entries = in_rig_order(rig, options.cameras);
    if (!entries) return tl::unexpected(entries.error());
    const auto report = [events = std::move(events)](const CameraEvent& event) {
        if (events) events(event.is_warning, event.text);
    };
    report_sockets(options, rig, report);
    auto cameras = std::make_unique<Cameras>(options, rig, report);
    for (std::size_t i = 0; i < rig.cameras.size(); ++i) {
        cameras->cameras.push_back(std::make_unique<AravisCamera>(
            i, (*entries)[i], rig.cameras[i].intrinsics, cameras->shared_state));
    }
    if (options.trigger == TriggerMode::kSoftware) {
        cameras->trigger = std::jthread(
            [&all = *cameras](std::stop_token beat_stop) { all.run_trigger_beat(beat_stop); });
    }
    if (auto enough = cameras->wait_for_enough(stop); !enough)
        return tl::unexpected(enough.error());
    config::Rig known = rig;
    for (std::size_t i = 0; i < known.cameras.size(); ++i) {
        geometry::PinholeCamera& lens = known.cameras[i].intrinsics;
        if (lens.width != 0) continue;
        const auto size = cameras->cameras[i]->size_px();
        lens.width = size[0];
        lens.height = size[1];
    }
    return std::unique_ptr<AravisSource>(new AravisSource(known, std::move(cameras)));
}

// Takes all pending frames. Returns false after a while without any.
bool AravisSource::take(std::stop_token stop, std::vector<CameraFrame>& frames) {
    constexpr std::chrono::milliseconds kPatience{200};
    auto& too_old = cameras_->num_too_old;
    std::fill(too_old.begin(), too_old.end(), 0);
    const bool taken = cameras_->shared_state.mailbox.take(stop, kPatience, frames, too_old);
    for (std::size_t i = 0; i < too_old.size(); ++i)
        cameras_->cameras[i]->count_too_old(too_old[i]);
    return taken;
}

Expected<void> AravisSource::run(std::stop_token stop, const Sink& sink) {
    cameras_->shared_state.mailbox.listen_to_all();
    std::vector<CameraFrame> frames;
    while (!stop.stop_requested()) {
        if (!take(stop, frames) || frames.empty()) continue;
        const Timestamp newest = frames.back().capture_time;
        for (CameraFrame& frame : frames) sink(std::move(frame));
        frames.clear();
        deliver_lost_frames(newest, sink);
    }
    cameras_->shared_state.mailbox.listen_to_none();
    return {};
}

// Reports a lost picture for each camera that is not connected or no longer answers: nobody needs
// to wait for it.
void AravisSource::deliver_lost_frames(Timestamp time, const Sink& sink) {
    for (std::size_t i = 0; i < cameras_->cameras.size(); ++i) {
        if (cameras_->cameras[i]->is_delivering()) continue;
        CameraFrame lost;
        lost.camera = i;
        lost.capture_time = time;
        sink(std::move(lost));
    }
}

// State of one camera in show_background.
struct AravisSource::Showing {
    std::chrono::steady_clock::time_point last_picture;
    std::size_t num_shown = 0;
    std::optional<Expected<void>> result;  // empty: not finished
};

std::vector<Expected<void>> AravisSource::show_background(const std::vector<std::size_t>& cameras,
                                                          const BackgroundSink& sink,
                                                          std::stop_token stop) {
    FrameMailbox& mailbox = cameras_->shared_state.mailbox;
    std::vector<Showing> all(rig_.cameras.size(), {std::chrono::steady_clock::now(), 0, {}});
    std::size_t num_showing = cameras.size();
    std::vector<CameraFrame> frames;
    image::YuvImage buffer;
    const auto end = [&](std::size_t camera, Expected<void> result) {
        all[camera].result = std::move(result);
        mailbox.ignore(camera);
        --num_showing;
    };
    mailbox.listen_to(cameras);
    while (num_showing > 0 && !stop.stop_requested()) {
        take(stop, frames);
        for (CameraFrame& frame : frames) {
            Showing& showing = all[frame.camera];
            if (frame.image.empty() || stop.stop_requested()) continue;
            showing.last_picture = std::chrono::steady_clock::now();
            ++showing.num_shown;
            if (!sink(frame.camera, image::working_view(frame.image, buffer)))
                end(frame.camera, {});
            frame.image = {};  // returns its buffer now, not after those of the others
        }
        frames.clear();
        for (const std::size_t camera : cameras) {
            if (!all[camera].result && is_silent_too_long(camera, all[camera].last_picture))
                end(camera, too_few_pictures(all[camera].num_shown));
        }
    }
    mailbox.listen_to_none();
    std::vector<Expected<void>> results;
    for (const std::size_t camera : cameras) {
        results.push_back(all[camera].result.value_or(make_error(
            ErrorKind::kUnavailable,
            fmt::format("stopped after {} pictures of the empty room", all[camera].num_shown))));
    }
    return results;
}

bool AravisSource::is_silent_too_long(std::size_t camera,
                                      std::chrono::steady_clock::time_point last_picture) const {
    constexpr std::chrono::seconds kLongestWait{5};
    constexpr std::chrono::seconds kLongestWaitForMissing{1};
    const bool is_there = cameras_->cameras[camera]->is_connected();
    return std::chrono::steady_clock::now() - last_picture >
           (is_there ? kLongestWait : kLongestWaitForMissing);
}

std::vector<CameraCounters> AravisSource::camera_counters() const {
    std::vector<CameraCounters> counters;
    for (const auto& camera : cameras_->cameras) counters.push_back(camera->counters());
    return counters;
}

}  // namespace atrium::capture
