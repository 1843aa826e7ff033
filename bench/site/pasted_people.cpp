#include "bench/site/pasted_people.hpp"

#include "tests/support/random.hpp"

#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <opencv2/videoio.hpp>

#include <array>
#include <cmath>
#include <iostream>
#include <random>
#include <vector>

namespace atrium::bench {
namespace {

constexpr int kScenesPerRoom = 8;
constexpr double kNoise_lsb = 1.5;  // of the people: scaling has removed that of the sensor
constexpr int kBorder = 6;          // around a person, for blurring [px]

// A person without a room, in floating point.
struct CutOut {
    cv::Mat colour;  // premultiplied BGR
    cv::Mat cover;   // 0 to 1
};

std::vector<CutOut> cut_out_people(const std::string& root) {
    std::vector<CutOut> people;
    for (const auto& [recording, cameras] : {std::pair{"ring20", 20}, {"dancer", 8}}) {
        for (int i = 0; i < cameras; ++i) {
            const std::string folder = root + "/" + recording + "/" + cv::format("cam%02d", i);
            const cv::Mat bgr = cv::imread(folder + "/frames/000000.png");
            cv::Mat mask = cv::imread(folder + "/silhouettes/000000.png", cv::IMREAD_GRAYSCALE);
            if (bgr.empty() || mask.empty()) {
                std::cerr << folder << ": cannot be read\n";
                return {};
            }
            // the outermost pixels are mixed with the room of the recording
            cv::erode(mask > 127, mask, cv::Mat(), cv::Point(-1, -1), 2);
            cv::Mat labels, statistics, centres;
            const int num = cv::connectedComponentsWithStats(mask, labels, statistics, centres);
            int largest = 1;
            for (int k = 2; k < num; ++k) {
                if (statistics.at<int>(k, cv::CC_STAT_AREA) >
                    statistics.at<int>(largest, cv::CC_STAT_AREA))
                    largest = k;
            }
            const cv::Rect bounds(statistics.at<int>(largest, cv::CC_STAT_LEFT),
                                  statistics.at<int>(largest, cv::CC_STAT_TOP),
                                  statistics.at<int>(largest, cv::CC_STAT_WIDTH),
                                  statistics.at<int>(largest, cv::CC_STAT_HEIGHT));
            CutOut person;
            cv::Mat(labels(bounds) == largest).convertTo(person.cover, CV_32F, 1.0 / 255.0);
            bgr(bounds).convertTo(person.colour, CV_32FC3);
            cv::Mat cover3;
            cv::merge(std::vector<cv::Mat>(3, person.cover), cover3);
            person.colour = person.colour.mul(cover3);
            people.push_back(person);
        }
    }
    return people;
}

CutOut scaled(const CutOut& person, cv::Size size, double blur_px) {
    CutOut result;
    for (const auto& [from, to] :
         {std::pair{&person.colour, &result.colour}, {&person.cover, &result.cover}}) {
        cv::resize(*from, *to, size, 0.0, 0.0, cv::INTER_AREA);
        cv::copyMakeBorder(
            *to, *to, kBorder, kBorder, kBorder, kBorder, cv::BORDER_CONSTANT, cv::Scalar());
        cv::GaussianBlur(*to, *to, cv::Size(), blur_px);
    }
    return result;
}

// Darkens the floor around a place, twice.
void add_shadows(cv::Point2d feet, test::Random& random, cv::Mat& room) {
    for (int i = 0; i < 2; ++i) {
        const double centre = feet.x + test::between(random, -60.0, 60.0);
        const double half_width = test::between(random, 25.0, 60.0);
        const double half_height = test::between(random, 8.0, 20.0);
        const double depth = test::between(random, 0.1, 0.35);
        for (int y = 0; y < room.rows; ++y) {
            for (int x = 0; x < room.cols; ++x) {
                const double distance_sq = std::pow((x - centre) / half_width, 2) +
                                           std::pow((y - feet.y) / half_height, 2);
                room.at<cv::Vec3f>(y, x) *=
                    static_cast<float>(1.0 - depth * std::exp(-distance_sq));
            }
        }
    }
}

// Puts a person of random size and brightness into `scene`, whose picture is an empty room.
void paste(const CutOut& person, test::Random& random, SegmentationScene& scene) {
    cv::Mat room;
    scene.picture.convertTo(room, CV_32FC3);
    std::normal_distribution<double> noise_lsb(0.0, kNoise_lsb);
    const double size = test::between(random, 160.0, 330.0) / person.cover.rows;
    const cv::Size px(static_cast<int>(size * person.cover.cols),
                      static_cast<int>(size * person.cover.rows));
    const CutOut small = scaled(person, px, test::between(random, 0.3, 1.2));
    const double light = test::between(random, 0.7, 1.5);
    const int x = test::between(random, 0, room.cols - small.cover.cols);
    const int lowest = room.rows - small.cover.rows - 12;
    const int y = test::between(random, std::max(0, lowest - 120), lowest);
    add_shadows({x + px.width / 2.0, y + 1.0 * px.height}, random, room);
    scene.truth = cv::Mat::zeros(room.size(), CV_8U);
    for (int row = 0; row < small.cover.rows; ++row) {
        for (int column = 0; column < small.cover.cols; ++column) {
            const float cover = std::min(small.cover.at<float>(row, column), 1.0F);
            cv::Vec3f& pixel = room.at<cv::Vec3f>(y + row, x + column);
            for (int i = 0; i < 3; ++i) {
                const auto noise = static_cast<float>(noise_lsb(random));
                pixel[i] = (1.0F - cover) * pixel[i] + cover * noise +
                           static_cast<float>(light) * small.colour.at<cv::Vec3f>(row, column)[i];
            }
            scene.truth.at<std::uint8_t>(y + row, x + column) = cover >= 0.5F ? 255 : 0;
        }
    }
    room.convertTo(scene.picture, CV_8UC3);
    if (test::between(random, 0.0, 1.0) < 0.5) return;
    cv::Mat yuv;
    cv::cvtColor(scene.picture, yuv, cv::COLOR_BGR2YUV_I420);
    cv::cvtColor(yuv, scene.picture, cv::COLOR_YUV2BGR_I420);
}

}  // namespace

bool visit_pasted_people(const std::string& recordings,
                         const std::function<void(const SegmentationScene&)>& visit) {
    const std::vector<CutOut> people = cut_out_people(recordings);
    if (people.empty()) return false;
    test::Random random(20);
    for (const char* camera : {"cam1", "cam2", "cam3", "cam4"}) {
        std::vector<cv::Mat> pictures;
        const std::string path = recordings + "/horseman/" + camera + "/background.avi";
        cv::VideoCapture video(path);
        for (cv::Mat bgr; video.read(bgr);) pictures.push_back(bgr.clone());
        if (pictures.size() < 2) {
            std::cerr << path << ": cannot be read\n";
            return false;
        }
        const std::size_t half = pictures.size() / 2;
        for (int i = 0; i < kScenesPerRoom; ++i) {
            SegmentationScene scene{"pasted people", camera, {}, {}, {}, {}, {}};
            scene.empty.assign(pictures.begin(), pictures.begin() + static_cast<long>(half));
            scene.picture = pictures[half + static_cast<std::size_t>(test::between(
                                                random, 0, static_cast<int>(half) - 1))]
                                .clone();
            paste(people[static_cast<std::size_t>(
                      test::between(random, 0, static_cast<int>(people.size()) - 1))],
                  random,
                  scene);
            visit(scene);
        }
    }
    return true;
}

}  // namespace atrium::bench
