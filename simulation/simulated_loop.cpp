#include "simulation/simulated_loop.hpp"

#include "simulation/loop_cache.hpp"
#include "simulation/mapped_file.hpp"
#include "simulation/render_lock.hpp"
#include "simulation/room_renderer.hpp"

namespace atrium::simulation {

image::YuvView view_of(const Picture& picture) {
    image::YuvImage unused;
    return image::working_view(picture, unused);
}

bool copy_to_memory_if_wanted(SimulatedLoop& loop) {
    if (loop.file == nullptr || !loop.file->is_wanted()) return false;
    const std::span<const std::uint8_t> old = loop.file->bytes();
    const auto copy = std::make_shared<const std::vector<std::uint8_t>>(old.begin(), old.end());
    for (auto* const pictures : {&loop.empty_room, &loop.frames}) {
        for (std::vector<Picture>& several : *pictures) {
            for (Picture& picture : several) {
                for (auto& plane : picture.planes)
                    plane.data = copy->data() + (plane.data - old.data());
                picture.owner = copy;
            }
        }
    }
    loop.file.reset();
    return true;
}

Expected<SimulatedLoop> render_loop(const std::vector<geometry::CalibratedCamera>& cameras,
                                    const RoomOptions& options,
                                    const LoopProgress& progress,
                                    std::stop_token stop) {
    auto renderer = RoomRenderer::create(cameras, options);
    if (!renderer) return tl::unexpected(renderer.error());
    const auto num_frames = static_cast<std::size_t>(options.num_frames());
    const auto num_empty = static_cast<std::size_t>(options.num_empty_frames);
    const std::size_t num_pictures = cameras.size() * (num_frames + num_empty);
    std::size_t num_done = 0;
    const auto picture = [&](double time_s, std::size_t camera, Scene scene, std::size_t shot) {
        auto image = std::make_shared<image::YuvImage>();
        renderer->render(time_s, camera, scene, static_cast<std::uint32_t>(shot), *image);
        ++num_done;
        if (progress) progress(num_done, num_pictures);
        return Picture(std::shared_ptr<const image::YuvImage>(std::move(image)));
    };
    const auto stopped = [] {
        return make_error(ErrorKind::kUnavailable, "simulation: rendering was stopped");
    };

    SimulatedLoop loop;
    loop.empty_room.resize(cameras.size());
    for (std::size_t camera = 0; camera < cameras.size(); ++camera) {
        for (std::size_t shot = 0; shot < num_empty; ++shot) {
            if (stop.stop_requested()) return stopped();
            loop.empty_room[camera].push_back(picture(0.0, camera, Scene::kEmptyRoom, shot));
        }
    }
    loop.frames.resize(num_frames);
    for (std::size_t i = 0; i < num_frames; ++i) {
        for (std::size_t camera = 0; camera < cameras.size(); ++camera) {
            if (stop.stop_requested()) return stopped();
            const double time_s = options.frame_time_s(static_cast<int>(i));
            loop.frames[i].push_back(picture(time_s, camera, Scene::kPerson, 0));
        }
    }
    return loop;
}

Expected<CachedLoop> load_or_render_loop(const std::vector<geometry::CalibratedCamera>& cameras,
                                         const RoomOptions& options,
                                         const std::filesystem::path& cache_directory,
                                         const LoopProgress& progress,
                                         std::stop_token stop) {
    if (auto valid = check(options); !valid) return tl::unexpected(valid.error());
    const std::filesystem::path file = cache_file(cameras, options, cache_directory);
    if (auto cached = read_cached_loop(file, cameras, options))
        return CachedLoop{
            .loop = *std::move(cached), .from_cache = true, .written = {}, .cache_problem = {}};
    const auto on_wait = [&] {
        if (progress) progress(0, 0);
    };
    const RenderLock lock = RenderLock::wait(file, on_wait, stop);
    if (auto cached = read_cached_loop(file, cameras, options))
        return CachedLoop{
            .loop = *std::move(cached), .from_cache = true, .written = {}, .cache_problem = {}};
    auto rendered = render_loop(cameras, options, progress, std::move(stop));
    if (!rendered) return tl::unexpected(rendered.error());
    CachedLoop result{
        .loop = *std::move(rendered), .from_cache = false, .written = {}, .cache_problem = {}};
    if (auto written = write_cached_loop(file, cameras, options, result.loop); !written)
        result.cache_problem = written.error();
    else
        result.written = file;
    return result;
}

}  // namespace atrium::simulation
