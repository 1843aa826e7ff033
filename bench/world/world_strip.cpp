// Puts some pictures of a film side by side, the middle of each: world_strip FILM PICTURE WIDTH_PX
// AT_S... Times below 0 count from the film's end.
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <opencv2/videoio.hpp>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <string>
#include <vector>

namespace {

// The middle of a picture at 8:5, `width_px` wide.
cv::Mat middle_of(const cv::Mat& picture, int width_px) {
    const int columns = std::min(picture.cols, picture.rows * 8 / 5);
    const cv::Rect middle((picture.cols - columns) / 2, 0, columns, picture.rows);
    cv::Mat small;
    cv::resize(picture(middle),
               small,
               {width_px, width_px * picture.rows / columns},
               0,
               0,
               cv::INTER_AREA);
    return small;
}

}  // namespace

int main(int argc, char** argv) {
    if (argc < 5) {
        std::fprintf(stderr, "usage: world_strip FILM PICTURE WIDTH_PX AT_S...\n");
        return 2;
    }
    const int width_px = std::stoi(argv[3]);
    cv::VideoCapture film(argv[1]);
    const double rate_hz = film.get(cv::CAP_PROP_FPS);
    const auto num_pictures = static_cast<long>(film.get(cv::CAP_PROP_FRAME_COUNT));
    std::map<long, cv::Mat> wanted;
    std::vector<long> order;
    for (int i = 4; i < argc; ++i) {
        const long number = std::lround(std::stod(argv[i]) * rate_hz);
        order.push_back(number < 0 ? num_pictures + number : number);
        wanted[order.back()];
    }
    for (long i = 0; film.grab() && i <= wanted.rbegin()->first; ++i) {
        const auto found = wanted.find(i);
        cv::Mat picture;
        if (found == wanted.end() || !film.retrieve(picture)) continue;
        found->second = middle_of(picture, width_px);
    }
    std::vector<cv::Mat> chosen;
    for (const long number : order) {
        if (wanted[number].empty()) {
            std::fprintf(stderr,
                         "%s: has %ld pictures, %.1f each second, but no number %ld\n",
                         argv[1],
                         num_pictures,
                         rate_hz,
                         number);
            return 1;
        }
        chosen.push_back(wanted[number]);
    }
    cv::Mat strip;
    cv::hconcat(chosen, strip);
    // 64 levels per channel are enough for a page, at half the bytes
    strip = strip & cv::Scalar::all(0xfc);
    if (!cv::imwrite(argv[2], strip, {cv::IMWRITE_PNG_COMPRESSION, 9})) {
        std::fprintf(stderr, "cannot write %s\n", argv[2]);
        return 1;
    }
    return 0;
}
