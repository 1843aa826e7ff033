#include "site_node/segmentation/segmentation.hpp"

#include <gtest/gtest.h>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/videoio.hpp>

#include <filesystem>
#include <string>

namespace atrium::segmentation {
namespace {

image::YuvImage yuv(const cv::Mat& bgr) {
    image::YuvImage image;
    image::yuv_from_bgr(bgr.data, bgr.cols, bgr.rows, bgr.step, image);
    return image;
}

double intersection_over_union(const image::Mask& mask, const cv::Mat& truth) {
    double both = 0;
    double either = 0;
    for (int y = 0; y < mask.height; ++y) {
        for (int x = 0; x < mask.width; ++x) {
            const bool a = mask.at(x, y) != 0;
            const bool b = truth.at<std::uint8_t>(y, x) > 127;
            both += a && b;
            either += a || b;
        }
    }
    return both / either;
}

// Four people, masks drawn by hand. The best that OpenCV's subtractors reach there, with a
// threshold chosen per picture, is 0.901 (MOG2) and 0.907 (KNN).
TEST(SegmentationRecording, AgreesWithMasksDrawnByHand) {
    const std::string root = ATRIUM_SOURCE_DIR "/../shared/data/recordings/fourpersons_a";
    if (!std::filesystem::exists(root)) GTEST_SKIP() << root << " is not there";
    double sum = 0.0;
    SegmentationScratch scratch;
    image::Mask mask;
    for (const char* camera : {"cam1", "cam2", "cam3", "cam4"}) {
        const std::string folder = root + "/" + camera;
        BackgroundLearner learner;
        cv::VideoCapture video(folder + "/background.avi");
        for (cv::Mat bgr; video.read(bgr);) ASSERT_TRUE(learner.add(yuv(bgr)).has_value());
        const auto model = learner.finish({});
        ASSERT_TRUE(model.has_value());
        const image::YuvImage frame = yuv(cv::imread(folder + "/frames/000000.png"));
        ASSERT_TRUE(segment(frame, *model, {}, scratch, mask).has_value());
        const double iou = intersection_over_union(
            mask, cv::imread(folder + "/masks_by_hand/000000.png", cv::IMREAD_GRAYSCALE));
        EXPECT_GT(iou, 0.87) << camera;
        sum += iou;
    }
    EXPECT_GT(sum / 4.0, 0.90);
}

}  // namespace
}  // namespace atrium::segmentation
