#include "site_node/capture/mask_values.hpp"

#include <opencv2/core/mat.hpp>

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>

namespace atrium::capture {
namespace {

constexpr std::size_t kMostNumbers = 8;  // of people or kinds; blurred outlines have more values
constexpr int kLargestByte = 255;

template <typename Sample>
bool has_transparency(const cv::Mat& picture) {
    const int num = picture.channels();
    if (num != 2 && num != 4) return false;
    for (int y = 0; y < picture.rows; ++y) {
        const Sample* const row = picture.ptr<Sample>(y);
        for (int x = 0; x < picture.cols; ++x)
            if (row[x * num + num - 1] != std::numeric_limits<Sample>::max()) return true;
    }
    return false;
}

// A few colours on black, as masks with a palette have them; not if all are grey.
template <typename Sample>
bool is_of_few_colours(const cv::Mat& picture) {
    using Colour = std::array<Sample, 3>;
    const int num = picture.channels();
    std::array<Colour, kMostNumbers + 1> known{};  // the first one is black
    std::size_t num_known = 1;
    bool has_colour = false;
    Colour former{};
    for (int y = 0; y < picture.rows; ++y) {
        const Sample* row = picture.ptr<Sample>(y);
        for (int x = 0; x < picture.cols; ++x, row += num) {
            const Colour colour{row[0], row[1], row[2]};
            if (colour == former) continue;
            former = colour;
            const auto end = known.begin() + static_cast<std::ptrdiff_t>(num_known);
            if (std::find(known.begin(), end, colour) != end) continue;
            if (num_known == known.size()) return false;
            known[num_known++] = colour;
            has_colour = has_colour || colour[0] != colour[1] || colour[1] != colour[2];
        }
    }
    return has_colour;
}

// Whether at most kMostNumbers values beside 0 occur; all are small.
template <typename Sample>
bool is_of_few_numbers(const cv::Mat& picture, int channel) {
    const int num = picture.channels();
    std::array<bool, kLargestByte + 1> occurs{};
    for (int y = 0; y < picture.rows; ++y) {
        const Sample* const row = picture.ptr<Sample>(y) + channel;
        for (int x = 0; x < picture.cols; ++x) occurs[row[x * num]] = true;
    }
    return static_cast<std::size_t>(std::count(occurs.begin() + 1, occurs.end(), true)) <=
           kMostNumbers;
}

// The largest value that is background.
template <typename Sample>
int largest_background(const cv::Mat& picture, int channel) {
    const int num = picture.channels();
    int most = 0;
    for (int y = 0; y < picture.rows; ++y) {
        const Sample* const row = picture.ptr<Sample>(y) + channel;
        for (int x = 0; x < picture.cols; ++x) most = std::max<int>(most, row[x * num]);
    }
    if (most <= kLargestByte / 2 && is_of_few_numbers<Sample>(picture, channel)) return 0;
    const int largest = most <= kLargestByte ? kLargestByte : std::numeric_limits<Sample>::max();
    return largest / 2;
}

template <typename Sample>
void mask_of(const cv::Mat& picture, image::Mask& out) {
    const int num = picture.channels();
    const auto write = [&](const auto& is_person) {
        out = image::Mask(picture.cols & ~1, picture.rows & ~1);
        for (int y = 0; y < out.height; ++y) {
            const Sample* pixel = picture.ptr<Sample>(y);
            for (int x = 0; x < out.width; ++x, pixel += num)
                out.row(y)[x] = is_person(pixel) ? 255 : 0;
        }
    };
    const bool is_cut_out = has_transparency<Sample>(picture);
    if (!is_cut_out && num >= 3 && is_of_few_colours<Sample>(picture)) {
        write([](const Sample* pixel) { return (pixel[0] | pixel[1] | pixel[2]) != 0; });
        return;
    }
    // of the colours, green carries most of the luma
    const int channel = is_cut_out ? num - 1 : num >= 3 ? 1 : 0;
    const int background = largest_background<Sample>(picture, channel);
    write([&](const Sample* pixel) { return pixel[channel] > background; });
}

}  // namespace

bool is_in_colours(const cv::Mat& picture) {
    constexpr int kColourful = 32;  // difference of the channels; compression makes less
    constexpr int kShare = 50;      // of the pixels, at least one in as many
    const int num = picture.channels();
    if (picture.depth() != CV_8U || num < 3 || has_transparency<std::uint8_t>(picture) ||
        is_of_few_colours<std::uint8_t>(picture))
        return false;
    std::int64_t num_colourful = 0;
    for (int y = 0; y < picture.rows; ++y) {
        const std::uint8_t* pixel = picture.ptr<std::uint8_t>(y);
        for (int x = 0; x < picture.cols; ++x, pixel += num) {
            const auto [least, most] = std::minmax({pixel[0], pixel[1], pixel[2]});
            num_colourful += most - least > kColourful ? 1 : 0;
        }
    }
    return num_colourful * kShare > std::int64_t{picture.rows} * picture.cols;
}

bool mask_from(const cv::Mat& picture, image::Mask& out) {
    if (picture.depth() == CV_8U) {
        mask_of<std::uint8_t>(picture, out);
    } else if (picture.depth() == CV_16U) {
        mask_of<std::uint16_t>(picture, out);
    } else {
        return false;
    }
    return true;
}

}  // namespace atrium::capture
