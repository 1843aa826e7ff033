#include "site_node/segmentation/segmentation.hpp"
#include "tests/support/skips.hpp"
#include "tests/support/source_dir.hpp"

#include <gtest/gtest.h>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/videoio.hpp>

#include <algorithm>
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

const std::string kRecordings = atrium::test::source_dir() + "/../shared/data/recordings/";

Segmenter learned(const std::string& folder) {
    BackgroundLearner learner;
    cv::VideoCapture video(folder + "/background.avi");
    for (cv::Mat bgr; video.read(bgr);) EXPECT_TRUE(learner.add(yuv(bgr)).has_value());
    return {learner.finish().value(), {}};
}

// Four people with hand-drawn masks. The best of OpenCV's subtractors, with a threshold chosen per
// picture, reach 0.901 (MOG2) and 0.907 (KNN).
TEST(SegmentationRecording, AgreesWithHandDrawnMasks) {
    const std::string root = kRecordings + "fourpersons_a";
    if (!std::filesystem::exists(root)) GTEST_SKIP() << atrium::test::skip::kNoSharedData << root;
    double sum = 0.0;
    image::Mask mask;
    for (const char* camera : {"cam1", "cam2", "cam3", "cam4"}) {
        const std::string folder = root + "/" + camera;
        Segmenter segmenter = learned(folder);
        const image::YuvImage frame = yuv(cv::imread(folder + "/frames/000000.png"));
        ASSERT_TRUE(segmenter.segment(frame, mask).has_value());
        const double iou = intersection_over_union(
            mask, cv::imread(folder + "/masks_by_hand/000000.png", cv::IMREAD_GRAYSCALE));
        EXPECT_GT(iou, 0.9) << camera;
        sum += iou;
    }
    EXPECT_GT(sum / 4.0, 0.93);
}

// One person sits still for 426 frames. The room must not grow into the person while it follows the
// light, nor the person into the room.
TEST(SegmentationRecording, PersonWhoSitsStillStays) {
    const std::string root = kRecordings + "horseman";
    if (!std::filesystem::exists(root)) GTEST_SKIP() << atrium::test::skip::kNoSharedData << root;
    for (const char* camera : {"cam1", "cam2", "cam4"}) {
        Segmenter segmenter = learned(root + "/" + camera);
        cv::VideoCapture video(root + "/" + camera + "/frames.avi");
        image::Mask mask;
        double first = 0.0;
        double last = 0.0;
        int number = 0;
        for (cv::Mat bgr; video.read(bgr); ++number) {
            ASSERT_TRUE(segmenter.segment(yuv(bgr), mask).has_value());
            const auto count = static_cast<double>(
                std::count(mask.data.begin(), mask.data.end(), std::uint8_t{255}));
            if (number < 20) first += count / 20;
            if (number >= 400 && number < 420) last += count / 20;
        }
        ASSERT_GE(number, 420);
        // a few percent of the picture, and the same at the end
        EXPECT_GT(first, 0.02 * 644 * 486) << camera;
        EXPECT_LT(first, 0.09 * 644 * 486) << camera;
        EXPECT_NEAR(last / first, 1.0, 0.1) << camera;
    }
}

}  // namespace
}  // namespace atrium::segmentation
