#include "site_node/simulated_room/rendered_source.hpp"

#include "site_node/capture/pace.hpp"

#include <chrono>
#include <memory>
#include <utility>

namespace atrium::simulated_room {
namespace {

image::RawImage grey_image(std::shared_ptr<const image::Plane> plane) {
    image::RawImage raw;
    raw.format = image::PixelFormat::kMono8;
    raw.width = plane->width;
    raw.height = plane->height;
    raw.planes[0] = {plane->data.data(), static_cast<std::size_t>(plane->width)};
    raw.owner = std::move(plane);
    return raw;
}

}  // namespace

RenderedSource::RenderedSource(config::Rig rig,
                               std::unique_ptr<const simulation::RenderedRoom> room,
                               const simulation::WrongCameras& wrong)
    : rig_(std::move(rig)), wrong_(wrong), counters_(rig_), room_(std::move(room)) {}

std::vector<Expected<void>> RenderedSource::show_background(const std::vector<std::size_t>& cameras,
                                                            const BackgroundSink& sink,
                                                            std::stop_token stop) {
    const auto show = [&](std::size_t camera) -> Expected<void> {
        image::YuvImage buffer;
        for (std::uint64_t shot = 0; !stop.stop_requested(); ++shot) {
            const auto plane = std::make_shared<image::Plane>();
            room_->render_empty(shot, wrong_.rendered_index(camera, 0.0), *plane);
            if (!sink(camera, image::working_view(grey_image(plane), buffer))) break;
        }
        return {};
    };
    return capture::one_after_another(cameras, show, stop);
}

Expected<void> RenderedSource::run(std::stop_token stop, const Sink& sink) {
    capture::Pace pace(std::chrono::nanoseconds(static_cast<std::int64_t>(1e9 / rig_.rate_hz)));
    for (std::uint64_t instant = 0; pace.wait(stop); ++instant) {
        const double time_s = static_cast<double>(instant) / rig_.rate_hz;
        const Timestamp now = pace.due_time();
        for (std::size_t camera = 0; camera < rig_.cameras.size() && !stop.stop_requested();
             ++camera) {
            if (room_->is_lost(time_s, camera)) {
                counters_.count_incomplete(camera);
                sink({camera, now, {}, nullptr});
                continue;
            }
            auto plane = std::make_shared<image::Plane>();
            room_->render(time_s - wrong_.late_instants(camera) / rig_.rate_hz,
                          wrong_.rendered_index(camera, time_s),
                          *plane);
            counters_.count_received(camera);
            sink({camera, now, grey_image(std::move(plane)), nullptr});
        }
    }
    return {};
}

}  // namespace atrium::simulated_room
