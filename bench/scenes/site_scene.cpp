#include "bench/scenes/site_scene.hpp"

#include "simulation/sensor_noise.hpp"
#include "simulation/simulated_loop.hpp"
#include "tests/support/pictures/bgr_from_yuv.hpp"

#include <cstdint>

namespace atrium::bench {
namespace {

constexpr std::size_t kEmptyShots = 16;

// The full-body rig with square pictures of the same vertical field of view.
Expected<config::Rig> square_rig(int side_px) {
    auto rig = config::load_rig(ATRIUM_SOURCE_DIR "/deploy/rigs/full_body.toml");
    if (!rig) return rig;
    for (geometry::CalibratedCamera& camera : rig->cameras) {
        geometry::PinholeCamera& k = camera.intrinsics;
        const double scale = static_cast<double>(side_px) / k.height;
        k.fx *= scale;
        k.fy *= scale;
        k.width = k.height = side_px;
        k.cx = k.cy = 0.5 * (side_px - 1);
    }
    return rig;
}

/// Converts rendered pictures to a sensor's format.
class Sensor {
public:
    explicit Sensor(const SiteSceneOptions& options)
        : format_(options.format), noise_(options.noise_lsb, 1) {}

    image::RawImage expose(const image::YuvView& scene) {
        const int width = scene.width();
        const int height = scene.height();
        const std::vector<std::uint8_t> bgr = test::bgr_from_yuv(scene);
        const std::size_t row_bytes = image::row_bytes(format_, width);
        auto memory = std::make_shared<std::vector<std::uint8_t>>(row_bytes *
                                                                  static_cast<std::size_t>(height));
        const image::Mosaic mosaic = image::mosaic_of(format_);
        for (int y = 0; y < height; ++y) {
            std::uint8_t* row = memory->data() + static_cast<std::size_t>(y) * row_bytes;
            const std::uint8_t* source =
                bgr.data() + static_cast<std::size_t>(y) * static_cast<std::size_t>(width) * 3;
            if (mosaic == image::Mosaic::kNone) {
                std::copy_n(source, row_bytes, row);
            } else {
                sample(source, y, width, mosaic, row);
            }
            noise_.add(num_exposed_, y, {row, row_bytes});
        }
        ++num_exposed_;
        image::RawImage raw;
        raw.format = format_;
        raw.width = width;
        raw.height = height;
        raw.planes[0] = {memory->data(), row_bytes};
        raw.owner = std::move(memory);
        return raw;
    }

private:
    // One colour per pixel, by its filter.
    static void sample(
        const std::uint8_t* bgr, int y, int width, image::Mosaic mosaic, std::uint8_t* out) {
        const image::RedAt red = image::red_at(mosaic);
        for (int x = 0; x < width; ++x) {
            const bool red_column = (x & 1) == red.x;
            const bool red_row = (y & 1) == red.y;
            const int channel = red_column != red_row ? 1 : (red_row ? 2 : 0);
            out[x] = bgr[3 * x + channel];
        }
    }

    image::PixelFormat format_;
    simulation::SensorNoise noise_;
    std::uint64_t num_exposed_ = 0;
};

}  // namespace

Expected<SiteScene> SiteScene::create(const SiteSceneOptions& options) {
    auto rig = square_rig(options.side_px);
    if (!rig) return tl::unexpected(rig.error());
    simulation::RoomOptions room;
    room.motion = "wave";
    room.loop_s = 1.0;
    room.rate_hz = options.num_instants;
    room.noise_lsb = 0.0;  // the sensor's noise is added here
    room.num_empty_frames = 1;
    const auto rendered =
        simulation::load_or_render_loop(rig->cameras, room, options.cache, {}, {});
    if (!rendered) return tl::unexpected(rendered.error());

    SiteScene scene;
    scene.rig_ = std::move(*rig);
    Sensor sensor(options);
    for (const auto& shots : rendered->loop.empty_room) {
        auto& own = scene.empty_room_.emplace_back();
        for (std::size_t i = 0; i < kEmptyShots; ++i)
            own.push_back(sensor.expose(simulation::view_of(shots[i % shots.size()])));
    }
    for (const auto& instant : rendered->loop.frames) {
        auto& own = scene.frames_.emplace_back();
        for (const simulation::Picture& picture : instant)
            own.push_back(sensor.expose(simulation::view_of(picture)));
    }
    return scene;
}

std::vector<Expected<void>> SiteScene::show_background(const std::vector<std::size_t>& cameras,
                                                       const BackgroundSink& sink,
                                                       std::stop_token stop) {
    image::YuvImage buffer;
    const auto show = [&](std::size_t camera) -> Expected<void> {
        for (const image::RawImage& shot : empty_room_[camera]) {
            if (stop.stop_requested() || !sink(camera, image::working_view(shot, buffer))) break;
        }
        return {};
    };
    return capture::one_after_another(cameras, show, stop);
}

Expected<void> SiteScene::run(std::stop_token stop, const Sink& sink) {
    const Timestamp begin = Timestamp::now();
    const auto period = std::chrono::nanoseconds(1'000'000'000) / frames_.size();
    for (std::size_t instant = 0; instant < frames_.size() && !stop.stop_requested(); ++instant) {
        const Timestamp time = begin + static_cast<std::int64_t>(instant) * period;
        for (std::size_t camera = 0; camera < rig_.cameras.size(); ++camera)
            sink({camera, time, frames_[instant][camera], nullptr});
    }
    return {};
}

}  // namespace atrium::bench
