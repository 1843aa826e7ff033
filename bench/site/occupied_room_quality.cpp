// How well a site learns its room from pictures with people in it: one row of comma-separated
// values per scene and way to get the room. `occupied_room_quality RECORDINGS RIG [FOLDER
// [SCENE]]` also writes the learned rooms and masks into FOLDER.

#include "bench/site/occupied_scenes.hpp"
#include "bench/value_of.hpp"
#include "core/base/executor.hpp"
#include "core/geometry/triangle_mesh.hpp"
#include "site_node/hull_stage.hpp"
#include "site_node/occupied_room/learn_occupied_room.hpp"
#include "site_node/segmentation/segmentation.hpp"
#include "site_node/silhouette_stage/silhouette_stage.hpp"

#include <opencv2/imgcodecs.hpp>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <memory>

namespace atrium::bench {
namespace {

using site_node::HullStage;
using site_node::HullStageOptions;
using site_node::SilhouetteStage;
using Masks = std::vector<std::vector<image::Mask>>;  // [camera][instant]
using Rooms = std::vector<segmentation::BackgroundStatistics>;

segmentation::BackgroundStatistics learned_from(const std::vector<image::YuvImage>& pictures) {
    segmentation::BackgroundLearner learner;
    for (const auto& picture : pictures) require(learner.add(picture));
    return value_of(learner.finish());
}

// What a user makes who has no empty room.
image::YuvImage median_of(const std::vector<image::YuvImage>& pictures) {
    image::YuvImage median = pictures.front();
    std::vector<std::uint8_t> values(pictures.size());
    for (image::Plane image::YuvImage::*plane :
         {&image::YuvImage::y, &image::YuvImage::u, &image::YuvImage::v}) {
        for (std::size_t i = 0; i < (median.*plane).data.size(); ++i) {
            for (std::size_t k = 0; k < pictures.size(); ++k)
                values[k] = (pictures[k].*plane).data[i];
            const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
            std::nth_element(values.begin(), middle, values.end());
            (median.*plane).data[i] = *middle;
        }
    }
    return median;
}

Masks segment(const OccupiedScene& scene, const Rooms& rooms) {
    Masks masks(scene.cameras.size());
    for (std::size_t camera = 0; camera < scene.cameras.size(); ++camera) {
        segmentation::Segmenter segmenter(rooms[camera], {});
        for (const auto& picture : scene.pictures[camera]) {
            masks[camera].emplace_back();
            require(segmenter.segment(picture, masks[camera].back()));
        }
    }
    return masks;
}

double mean_iou(const Masks& masks, const Masks& truth) {
    double sum = 0.0;
    double num = 0.0;
    for (std::size_t c = 0; c < masks.size(); ++c) {
        for (std::size_t i = 0; i < masks[c].size(); ++i) {
            double both = 0.0;
            double either = 0.0;
            for (std::size_t p = 0; p < masks[c][i].data.size(); ++p) {
                both += (masks[c][i].data[p] & truth[c][i].data[p]) != 0;
                either += (masks[c][i].data[p] | truth[c][i].data[p]) != 0;
            }
            sum += either == 0.0 ? 1.0 : both / either;
            num += 1.0;
        }
    }
    return sum / num;
}

double hull_litres(const OccupiedScene& scene, const Masks& masks) {
    HullStageOptions options;
    options.bounds = scene.bounds_site;
    auto stage = value_of(HullStage::create(scene.cameras, options, 1.0));
    SerialExecutor executor;
    hull::VisualHull hull;
    double sum = 0.0;
    const std::size_t step = std::max<std::size_t>(1, masks[0].size() / 10);
    double num = 0.0;
    for (std::size_t i = 0; i < masks[0].size(); i += step) {
        for (std::size_t c = 0; c < scene.cameras.size(); ++c) {
            SilhouetteStage silhouettes(scene.cameras[c], {});
            site_node::PictureSilhouette found;
            capture::CameraFrame frame;
            frame.image = image::RawImage(std::make_shared<image::YuvImage>(scene.pictures[c][i]));
            frame.silhouette = std::make_shared<image::Mask>(masks[c][i]);
            require(silhouettes.find(frame, {}, found));
            stage.contours(c) = found.contours;
        }
        stage.compute(std::vector<std::uint8_t>(scene.cameras.size(), 1), {}, executor, hull);
        sum += geometry::volume_m3(hull.mesh) * site_node::kLitresPerM3;
        num += 1.0;
    }
    return sum / num;
}

void write_pictures(const std::filesystem::path& folder,
                    const OccupiedScene& scene,
                    const std::string& method,
                    const Rooms& rooms,
                    const Masks& masks) {
    for (std::size_t c = 0; c < rooms.size(); ++c) {
        cv::Mat room(rooms[c].height, rooms[c].width, CV_8U);
        for (int y = 0; y < room.rows; ++y) {
            for (int x = 0; x < room.cols; ++x)
                room.at<std::uint8_t>(y, x) = static_cast<std::uint8_t>(
                    rooms[c].luma[static_cast<std::size_t>(y * room.cols + x)] / 256);
        }
        const std::string stem = scene.name + "_" + method + "_" + scene.cameras[c].name;
        cv::imwrite((folder / (stem + "_room.png")).string(), room);
        const image::Mask& mask = masks[c][masks[c].size() / 2];
        cv::imwrite(
            (folder / (stem + "_mask.png")).string(),
            cv::Mat(mask.height, mask.width, CV_8U, const_cast<std::uint8_t*>(mask.data.data())));
    }
}

void compare(const OccupiedScene& scene, const std::string& folder) {
    Rooms empty;
    Rooms mean;
    Rooms median;
    occupied_room::OccupiedRoom seen{scene.cameras, scene.bounds_site, {}};
    for (std::size_t c = 0; c < scene.cameras.size(); ++c) {
        empty.push_back(learned_from(scene.empty[c]));
        mean.push_back(learned_from(scene.pictures[c]));
        median.push_back(learned_from({median_of(scene.pictures[c])}));
        seen.pictures.emplace_back(scene.pictures[c].begin(), scene.pictures[c].end());
    }
    Rooms learned;
    const auto begin = std::chrono::steady_clock::now();
    double never_empty = 0.0;
    for (auto& room :
         occupied_room::learn_occupied_room(seen, {}, [](std::size_t, std::size_t) {}, {})) {
        never_empty = std::max(never_empty, value_of(room).never_empty);
        learned.push_back(std::move(room->room));
    }
    const double seconds =
        std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    const Masks masks_empty = segment(scene, empty);
    const Masks& truth = scene.truth.empty() ? masks_empty : scene.truth;
    for (const auto& [method, rooms] : {std::pair{"learned", &learned},
                                        {"empty", &empty},
                                        {"mean", &mean},
                                        {"median", &median}}) {
        if (std::getenv("QUICK") && method != std::string("learned")) continue;
        const Masks masks = segment(scene, *rooms);
        std::printf("%s,%s,%.4f,%.1f,%.1f,%.4f,%.1f\n",
                    scene.name.c_str(),
                    method,
                    mean_iou(masks, truth),
                    hull_litres(scene, masks),
                    hull_litres(scene, truth),
                    never_empty,
                    seconds);
        std::fflush(stdout);
        if (!folder.empty()) write_pictures(folder, scene, method, *rooms, masks);
    }
}

}  // namespace
}  // namespace atrium::bench

int main(int argc, char** argv) {
    using namespace atrium::bench;
    if (argc < 3) {
        std::fprintf(stderr, "usage: occupied_room_quality RECORDINGS RIG [FOLDER [SCENE]]\n");
        return 2;
    }
    const std::string folder = argc > 3 ? argv[3] : "";
    std::puts("scene,method,iou,hull_l,true_hull_l,never_empty,learning_s");
    const std::string only = argc > 4 ? argv[4] : "";
    for (const OccupiedPlay& play :
         {OccupiedPlay{.name = "moves"},
          {.name = "stands60", .still = 0.6},
          {.name = "sways60", .still = 0.6, .sways = true},
          {.name = "stands60_4", .still = 0.6, .num_cameras = 4},
          {.name = "stands80", .still = 0.8},
          {.name = "line60", .still = 0.6, .along_x = true},
          {.name = "line60_sways", .still = 0.6, .sways = true, .along_x = true},
          {.name = "line60_7", .still = 0.6, .sways = true, .along_x = true, .num_cameras = 7}})
        if (only.empty() || only == play.name) compare(simulated_scene(argv[2], play), folder);
    const std::string horseman = std::string(argv[1]) + "/horseman";
    if (std::filesystem::exists(horseman) && (only.empty() || only == "horseman"))
        compare(recorded_scene(horseman, 60), folder);
    return 0;
}
