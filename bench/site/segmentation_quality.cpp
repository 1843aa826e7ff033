// Quality and cost of masks, beside OpenCV's background subtractors on the same pictures: one row
// of comma-separated values per picture and method. Every method gets the same cleaning.
// `segmentation_quality [FOLDER]` also writes pictures of correct (white), false (red) and missed
// (blue) pixels into FOLDER. bench/site/segmentation_quality.sh keeps the tables.

#include "bench/site/segmentation_scenes.hpp"
#include "bench/value_of.hpp"
#include "core/image/raw_image.hpp"
#include "site_node/segmentation/segmentation.hpp"
#include "tests/support/shapes/whole_mask.hpp"

#include <opencv2/imgcodecs.hpp>
#include <opencv2/video/background_segm.hpp>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <filesystem>

namespace atrium::bench {
namespace {

using Clock = std::chrono::steady_clock;

struct Result {
    cv::Mat mask;
    double ms = 0.0;            // of one picture, the least of several
    double empty_share = -1.0;  // false part of later empty pictures; -1: there are none
};

double part_of(const cv::Mat& mask, const cv::Mat& area) {
    const int size = cv::countNonZero(area);
    return size == 0 ? 0.0 : static_cast<double>(cv::countNonZero(mask & area)) / size;
}

double intersection_over_union(const cv::Mat& mask, const cv::Mat& truth) {
    const int either = cv::countNonZero(mask | truth);
    return either == 0 ? 1.0 : static_cast<double>(cv::countNonZero(mask & truth)) / either;
}

template <typename Work>
double least_ms(int repetitions, Work&& work) {
    double least = 1e9;
    for (int i = 0; i < repetitions; ++i) {
        const auto begin = Clock::now();
        work();
        least = std::min(least,
                         std::chrono::duration<double, std::milli>(Clock::now() - begin).count());
    }
    return least;
}

image::RawImage raw(const cv::Mat& bgr) {
    image::RawImage image;
    image.format = image::PixelFormat::kBgr;
    image.width = bgr.cols;
    image.height = bgr.rows;
    image.planes[0] = {bgr.data, bgr.step};
    return image;
}

cv::Mat as_mat(const image::Mask& mask) {
    return cv::Mat(mask.height, mask.width, CV_8U, const_cast<std::uint8_t*>(mask.data.data()))
        .clone();
}

Result atrium_mask(const SegmentationScene& scene, bool refine_outline) {
    segmentation::SegmentationOptions options;
    options.refine_outline = refine_outline;
    segmentation::BackgroundLearner learner;
    image::YuvImage buffer;
    for (const cv::Mat& bgr : scene.empty)
        require(learner.add(image::working_view(raw(bgr), buffer)));
    auto room = learner.finish();
    if (!room) require(tl::unexpected(room.error()));
    segmentation::Segmenter segmenter(std::move(*room), options);
    image::SparseMask mask;
    Result result;
    const auto segment = [&](const cv::Mat& bgr) {
        image::WorkingPicture picture(raw(bgr), buffer);
        require(segmenter.segment(picture, mask));
    };
    for (const cv::Mat& bgr : scene.empty_later) {
        segment(bgr);
        result.empty_share = std::max(result.empty_share, 0.0) +
                             cv::countNonZero(as_mat(mask.mask)) /
                                 static_cast<double>(bgr.total() * scene.empty_later.size());
    }
    result.ms = least_ms(10, [&] { segment(scene.picture); });
    result.mask = as_mat(mask.mask);
    return result;
}

cv::Mat cleaned(const cv::Mat& bgr_mask) {
    // OpenCV marks shadows with 127
    const cv::Mat binary = bgr_mask > 200;
    image::Mask in(binary.cols, binary.rows);
    for (int y = 0; y < binary.rows; ++y)
        std::copy(binary.ptr(y), binary.ptr(y) + binary.cols, in.row(y));
    image::Mask out;
    segmentation::CleanScratch scratch;
    segmentation::test::majority_3x3(in, scratch, out);
    const segmentation::SegmentationOptions options;
    segmentation::test::remove_small_parts(out, options.min_area_px, options.max_hole_px, scratch);
    return as_mat(out);
}

template <typename Subtractor>
Result opencv_mask(const SegmentationScene& scene, Subtractor& subtractor) {
    cv::Mat mask;
    for (const cv::Mat& bgr : scene.empty) subtractor.apply(bgr, mask);
    Result result;
    for (const cv::Mat& bgr : scene.empty_later) {
        subtractor.apply(bgr, mask, 0.0);
        result.empty_share = std::max(result.empty_share, 0.0) +
                             cv::countNonZero(cleaned(mask)) /
                                 static_cast<double>(bgr.total() * scene.empty_later.size());
    }
    result.ms = least_ms(3, [&] { subtractor.apply(scene.picture, mask, 0.0); });
    result.mask = cleaned(mask);
    return result;
}

Result mog2(const SegmentationScene& scene, double threshold) {
    return opencv_mask(
        scene,
        *cv::createBackgroundSubtractorMOG2(static_cast<int>(scene.empty.size()), threshold, true));
}

Result knn(const SegmentationScene& scene, double threshold) {
    return opencv_mask(
        scene,
        *cv::createBackgroundSubtractorKNN(static_cast<int>(scene.empty.size()), threshold, true));
}

template <typename Method>
Result best(const SegmentationScene& scene, Method method, const std::vector<double>& thresholds) {
    Result result;
    double best_iou = -1.0;
    for (const double threshold : thresholds) {
        Result candidate = method(scene, threshold);
        const double iou = intersection_over_union(candidate.mask, scene.truth);
        if (iou <= best_iou) continue;
        best_iou = iou;
        result = std::move(candidate);
    }
    return result;
}

void report(const SegmentationScene& scene, const char* method, const Result& result) {
    const auto number = [](bool known, double value) {
        char text[32] = "";
        if (known) std::snprintf(text, sizeof text, "%.5f", value);
        return std::string(text);
    };
    const bool known = !scene.truth.empty();
    const double megapixels = 1e-6 * static_cast<double>(scene.picture.total());
    std::printf(
        "%s,%s,%s,%s,%s,%s,%.3f\n",
        scene.scene.c_str(),
        scene.camera.c_str(),
        method,
        number(known, known ? intersection_over_union(result.mask, scene.truth) : 0).c_str(),
        number(known, known ? part_of(result.mask, scene.shadow) : 0).c_str(),
        number(result.empty_share >= 0, result.empty_share).c_str(),
        result.ms / megapixels);
    std::fflush(stdout);
}

void draw(const SegmentationScene& scene, const cv::Mat& mask, const std::string& folder) {
    if (folder.empty()) return;
    cv::Mat picture = scene.picture.clone();
    picture *= 0.4;
    if (scene.truth.empty()) {
        scene.picture.copyTo(picture, mask);
    } else {
        scene.picture.copyTo(picture, mask & scene.truth);
        picture.setTo(cv::Scalar(0, 0, 255), mask & ~scene.truth);
        picture.setTo(cv::Scalar(255, 64, 0), ~mask & scene.truth);
    }
    std::string name = scene.scene + "_" + scene.camera;
    std::replace_if(
        name.begin(), name.end(), [](char c) { return !isalnum(c); }, '_');
    cv::imwrite(folder + "/" + name + ".png", picture);
}

int run(const std::string& pictures, bool ours_only) {
    if (!pictures.empty()) std::filesystem::create_directories(pictures);
    cv::setNumThreads(1);
    std::puts("scene,camera,method,iou,false_in_shadow,false_in_empty_room,ms_per_mp");
    const bool done = visit_segmentation_scenes(
        ATRIUM_SOURCE_DIR "/../shared/data/recordings",
        ATRIUM_SOURCE_DIR "/deploy/rigs/full_body.toml",
        [&](const SegmentationScene& scene) {
            const Result ours = atrium_mask(scene, true);
            report(scene, "atrium", ours);
            draw(scene, ours.mask, pictures);
            report(scene, "atrium_unrefined", atrium_mask(scene, false));
            if (ours_only) return;
            report(scene, "mog2", mog2(scene, 16.0));
            report(scene, "knn", knn(scene, 400.0));
            if (scene.truth.empty()) return;
            report(scene, "mog2_best", best(scene, mog2, {4, 8, 12, 16, 24, 36, 50, 75, 100, 150}));
            report(scene,
                   "knn_best",
                   best(scene, knn, {50, 100, 150, 200, 300, 400, 600, 800, 1200, 2000}));
        });
    return done ? 0 : 1;
}

}  // namespace
}  // namespace atrium::bench

int main(int argc, char** argv) {
    const bool ours_only = argc > 1 && std::string(argv[argc - 1]) == "--ours-only";
    const int num_arguments = argc - (ours_only ? 1 : 0);
    return atrium::bench::run(num_arguments > 1 ? argv[1] : "", ours_only);
}
