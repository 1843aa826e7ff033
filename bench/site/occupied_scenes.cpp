#include "bench/site/occupied_scenes.hpp"

#include "bench/value_of.hpp"
#include "core/config/rig.hpp"
#include "core/image/raw_image.hpp"
#include "simulation/room_renderer.hpp"
#include "site_node/capture/recording_source.hpp"

#include <cmath>
#include <numbers>

namespace atrium::bench {
namespace {

image::YuvImage copy_of(const image::YuvView& view) {
    image::YuvImage copy{{view.y.width, view.y.height},
                         {view.u.width, view.u.height},
                         {view.v.width, view.v.height}};
    for (const auto& [from, to] :
         {std::pair{&view.y, &copy.y}, {&view.u, &copy.u}, {&view.v, &copy.v}}) {
        for (int y = 0; y < from->height; ++y) std::copy_n(from->row(y), from->width, to->row(y));
    }
    return copy;
}

// Places on a line, or on a spiral: no two are close.
Eigen::Vector3d place(std::size_t index, bool along_x) {
    if (along_x) return {0.8 * std::sin(2.4 * static_cast<double>(index)), 0.0, 0.0};
    const double turn = 2.4 * static_cast<double>(index);
    const double radius_m = 0.15 + 0.6 * std::fmod(0.37 * static_cast<double>(index), 1.0);
    return {radius_m * std::cos(turn), radius_m * std::sin(turn), 0.0};
}

}  // namespace

OccupiedScene recorded_scene(const std::string& folder, std::size_t num_instants) {
    auto source = value_of(capture::RecordingSource::open({.folder = folder}));
    OccupiedScene scene;
    scene.name = folder.substr(folder.find_last_of('/') + 1);
    scene.cameras = source->rig().cameras;
    scene.bounds_site = source->rig().bounds_site;
    scene.pictures.resize(scene.cameras.size());
    scene.empty.resize(scene.cameras.size());
    std::vector<std::size_t> all;
    for (std::size_t camera = 0; camera < scene.cameras.size(); ++camera) all.push_back(camera);
    for (const auto& shown :
         source->show_background(all,
                                 [&](std::size_t camera, const image::YuvView&picture) {
                                     scene.empty[camera].push_back(copy_of(picture));
                                     return true;
                                 },
                                 {}))
        require(shown);
    image::YuvImage buffer;
    for (const std::size_t camera : all) {
        for (std::size_t i = 0; i < num_instants; ++i) {
            const auto frame =
                source->read_picture(camera, i * source->num_frames() / num_instants);
            if (!frame) continue;
            scene.pictures[camera].push_back(copy_of(image::working_view(frame->image, buffer)));
        }
    }
    return scene;
}

OccupiedScene simulated_scene(const std::string& rig_file, const OccupiedPlay& play) {
    const auto rig = value_of(config::load_rig(rig_file));
    OccupiedScene scene;
    scene.name = play.name;
    scene.bounds_site = rig.bounds_site;
    for (std::size_t i = 0; i < play.num_cameras; ++i)
        scene.cameras.push_back(rig.cameras[i * rig.cameras.size() / play.num_cameras]);
    scene.pictures.resize(play.num_cameras);
    scene.truth.resize(play.num_cameras);
    scene.empty.resize(play.num_cameras);
    const auto num_still =
        static_cast<std::size_t>(std::lround(play.still * static_cast<double>(play.num_instants)));
    constexpr std::size_t kInstantsPerPlace = 2;
    std::size_t instant = 0;
    for (std::size_t where = 0; instant < play.num_instants; ++where) {
        const bool is_still = where == 0 && num_still > 0;
        simulation::RoomOptions options;
        options.look = play.look;
        options.motion = is_still ? "sway" : "walk";
        options.position_m = place(where, play.along_x);
        options.heading_rad = 1.9 * static_cast<double>(where);
        auto renderer = value_of(simulation::RoomRenderer::create(scene.cameras, options));
        const std::size_t num = is_still ? num_still : kInstantsPerPlace;
        for (std::size_t i = 0; i < num && instant < play.num_instants; ++i, ++instant) {
            const double time_s = is_still && !play.sways ? 0.0 : 0.37 * static_cast<double>(i);
            for (std::size_t camera = 0; camera < play.num_cameras; ++camera) {
                scene.pictures[camera].emplace_back();
                scene.truth[camera].emplace_back();
                renderer.render(time_s,
                                camera,
                                simulation::Scene::kPerson,
                                static_cast<std::uint32_t>(instant),
                                scene.pictures[camera].back(),
                                &scene.truth[camera].back());
            }
        }
        for (std::size_t camera = 0; camera < play.num_cameras && where == 0; ++camera) {
            for (std::uint32_t shot = 0; shot < 16; ++shot) {
                scene.empty[camera].emplace_back();
                renderer.render(
                    0.0, camera, simulation::Scene::kEmptyRoom, shot, scene.empty[camera].back());
            }
        }
    }
    return scene;
}

}  // namespace atrium::bench
