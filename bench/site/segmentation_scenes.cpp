#include "bench/site/segmentation_scenes.hpp"

#include "bench/site/pasted_people.hpp"
#include "core/config/rig.hpp"
#include "simulation/room_renderer.hpp"
#include "tests/support/pictures/bgr_from_yuv.hpp"

#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <opencv2/videoio.hpp>

#include <filesystem>
#include <iostream>

namespace atrium::bench {
namespace {

constexpr double kShadowBelow = 0.93;  // of the empty room's luma
constexpr double kShadowAbove = 0.3;   // darker pixels are no shadow of an ordinary room
constexpr double kMinShadowedLuma = 30.0;

std::vector<cv::Mat> read_video(const std::string& path) {
    std::vector<cv::Mat> pictures;
    cv::VideoCapture video(path);
    for (cv::Mat bgr; video.read(bgr);) pictures.push_back(bgr.clone());
    return pictures;
}

cv::Mat read_video_frame(const std::string& path, int index) {
    cv::VideoCapture video(path);
    cv::Mat bgr;
    for (int i = 0; i <= index; ++i) {
        if (!video.read(bgr)) return {};
    }
    return bgr;
}

cv::Mat luma(const cv::Mat& bgr) {
    cv::Mat grey;
    cv::cvtColor(bgr, grey, cv::COLOR_BGR2GRAY);
    return grey;
}

// Pixels without a person (at least three pixels away) that are darker than in the empty room.
cv::Mat shadow_of(const SegmentationScene& scene, double light) {
    cv::Mat mean = cv::Mat::zeros(scene.picture.size(), CV_32F);
    for (const cv::Mat& bgr : scene.empty) cv::accumulate(luma(bgr), mean);
    mean *= light / static_cast<double>(scene.empty.size());
    cv::Mat now;
    cv::blur(luma(scene.picture), now, cv::Size(3, 3));
    now.convertTo(now, CV_32F);
    cv::Mat person;
    cv::dilate(scene.truth, person, cv::getStructuringElement(cv::MORPH_ELLIPSE, cv::Size(7, 7)));
    return (person == 0) & (now < kShadowBelow * mean) & (now > kShadowAbove * mean) &
           (mean > kMinShadowedLuma);
}

bool visit_recordings(const std::string& root,
                      const std::function<void(const SegmentationScene&)>& visit) {
    for (const char* recording : {"fourpersons_a", "horseman"}) {
        for (const char* camera : {"cam1", "cam2", "cam3", "cam4"}) {
            const std::string folder = root + "/" + recording + "/" + camera;
            SegmentationScene scene{recording, camera, {}, {}, {}, {}, {}};
            scene.empty = read_video(folder + "/background.avi");
            const std::string truth = folder + "/masks_by_hand/000000.png";
            if (std::filesystem::exists(truth)) {
                scene.picture = cv::imread(folder + "/frames/000000.png");
                scene.truth = cv::imread(truth, cv::IMREAD_GRAYSCALE) > 127;
            } else {
                scene.picture = read_video_frame(folder + "/frames.avi", 100);
            }
            if (scene.empty.size() < 2 || scene.picture.empty()) {
                std::cerr << folder << ": cannot be read\n";
                return false;
            }
            if (!scene.truth.empty()) scene.shadow = shadow_of(scene, 1.0);
            const auto half = static_cast<std::ptrdiff_t>(scene.empty.size() / 2);
            scene.empty_later.assign(scene.empty.begin() + half, scene.empty.end());
            scene.empty.resize(static_cast<std::size_t>(half));
            visit(scene);
        }
    }
    return true;
}

struct Light {
    const char* scene;
    double noise_lsb;
    double light;
};

cv::Mat picture_of(const image::YuvImage& yuv, double light) {
    const std::vector<std::uint8_t> bytes = test::bgr_from_yuv(yuv);
    cv::Mat bgr(yuv.height(), yuv.width(), CV_8UC3);
    std::copy(bytes.begin(), bytes.end(), bgr.data);
    bgr.convertTo(bgr, -1, light);
    return bgr;
}

bool visit_room(const std::vector<geometry::CalibratedCamera>& cameras,
                const Light& light,
                const std::function<void(const SegmentationScene&)>& visit) {
    simulation::RoomOptions options;
    options.noise_lsb = light.noise_lsb;
    auto renderer = simulation::RoomRenderer::create(cameras, options);
    if (!renderer) {
        std::cerr << renderer.error().message << "\n";
        return false;
    }
    constexpr std::uint32_t kNumEmpty = 32;
    constexpr double kTime_s = 0.7;
    image::YuvImage yuv;
    for (std::size_t camera = 0; camera < cameras.size(); ++camera) {
        SegmentationScene scene{light.scene, cameras[camera].name, {}, {}, {}, {}, {}};
        for (std::uint32_t shot = 0; shot < kNumEmpty; ++shot) {
            renderer->render(0.0, camera, simulation::Scene::kEmptyRoom, shot, yuv);
            if (shot < kNumEmpty / 2) {
                scene.empty.push_back(picture_of(yuv, 1.0));
            } else {
                scene.empty_later.push_back(picture_of(yuv, light.light));
            }
        }
        image::Mask truth;
        renderer->render(kTime_s, camera, simulation::Scene::kPerson, kNumEmpty, yuv, &truth);
        scene.picture = picture_of(yuv, light.light);
        scene.truth = cv::Mat(truth.height, truth.width, CV_8U, truth.data.data()).clone();
        scene.shadow = shadow_of(scene, light.light);
        visit(scene);
    }
    return true;
}

}  // namespace

bool visit_segmentation_scenes(const std::string& recordings,
                               const std::string& rig,
                               const std::function<void(const SegmentationScene&)>& visit) {
    if (std::filesystem::exists(recordings)) {
        if (!visit_recordings(recordings, visit) || !visit_pasted_people(recordings, visit))
            return false;
    } else {
        std::cerr << recordings << " is not there: simulated rooms only\n";
    }
    auto loaded = config::load_rig(rig);
    if (!loaded) {
        std::cerr << loaded.error().message << "\n";
        return false;
    }
    auto& cameras = loaded->cameras;
    cameras.resize(std::min<std::size_t>(cameras.size(), 4));
    for (const Light& light : {Light{"room noise 2", 2.0, 1.0},
                               Light{"room noise 5", 5.0, 1.0},
                               Light{"room light +10 %", 2.0, 1.1},
                               Light{"room light -10 %", 2.0, 0.9}}) {
        if (!visit_room(cameras, light, visit)) return false;
    }
    return true;
}

}  // namespace atrium::bench
