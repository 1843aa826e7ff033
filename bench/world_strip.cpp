// Some pictures of a film side by side: world_strip FILM PICTURE [NUMBER [WIDTH_PX [FROM_S]]].
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <opencv2/videoio.hpp>

#include <cstdio>
#include <string>
#include <vector>

int main(int argc, char** argv) {
    if (argc < 3) {
        std::fprintf(stderr, "usage: world_strip FILM PICTURE [NUMBER [WIDTH_PX [FROM_S]]]\n");
        return 2;
    }
    const int number = argc > 3 ? std::stoi(argv[3]) : 4;
    const int width_px = argc > 4 ? std::stoi(argv[4]) : 480;
    const double from_s = argc > 5 ? std::stod(argv[5]) : 0.0;
    cv::VideoCapture film(argv[1]);
    std::vector<cv::Mat> pictures;
    for (cv::Mat picture; film.read(picture); picture = cv::Mat()) {
        cv::Mat small;
        const int height_px = width_px * picture.rows / picture.cols;
        cv::resize(picture, small, {width_px, height_px}, 0.0, 0.0, cv::INTER_AREA);
        pictures.push_back(small);
    }
    const double rate_hz = film.get(cv::CAP_PROP_FPS);
    const auto first = static_cast<std::size_t>(from_s * (rate_hz > 0.0 ? rate_hz : 30.0));
    if (number < 1 || pictures.size() < first + static_cast<std::size_t>(number)) {
        std::fprintf(stderr, "%s: has %zu pictures\n", argv[1], pictures.size());
        return 1;
    }
    std::vector<cv::Mat> chosen;
    const std::size_t last = pictures.size() - 1;
    for (int i = 0; i < number; ++i) {
        const std::size_t step = number > 1 ? (last - first) * static_cast<std::size_t>(i) /
                                                  static_cast<std::size_t>(number - 1)
                                            : 0;
        chosen.push_back(pictures[first + step]);
    }
    cv::Mat strip;
    cv::hconcat(chosen, strip);
    // 64 colours per channel are plenty for a page, and half the bytes
    strip = strip & cv::Scalar::all(0xfc);
    if (!cv::imwrite(argv[2], strip, {cv::IMWRITE_PNG_COMPRESSION, 9})) {
        std::fprintf(stderr, "cannot write %s\n", argv[2]);
        return 1;
    }
    return 0;
}
