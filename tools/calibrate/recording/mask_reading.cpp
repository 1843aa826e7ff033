#include "tools/calibrate/recording/mask_reading.hpp"

#include "site_node/capture/picture_file.hpp"
#include "site_node/capture/truncated_picture.hpp"
#include "tools/calibrate/names/name_parts.hpp"

#include <fmt/format.h>
#include <opencv2/imgcodecs.hpp>

#include <algorithm>
#include <array>
#include <cstdint>
#include <fstream>
#include <iterator>
#include <limits>
#include <optional>
#include <set>
#include <string_view>
#include <vector>

namespace atrium::calibrate {
namespace {

namespace fs = std::filesystem;
using Label = std::uint64_t;  // a number, or a colour with 16 bits per channel, red first

constexpr std::size_t kMostLabels = 64;   // beside the background, in one mask
constexpr std::size_t kFewestLabels = 3;  // with fewer, a site needs no help
constexpr double kFewestEqual = 0.75;     // of the neighbours

Label colour_of(Label red, Label green, Label blue) { return red << 32 | green << 16 | blue; }

// The first colour of a PNG's palette that is not grey as a whole. OpenCV returns colours, not
// their numbers.
std::optional<Label> background_in_palette(const fs::path& file) {
    constexpr int kMostChunks = 1000;
    constexpr std::uint8_t kWithPalette = 3;
    std::ifstream stream(file, std::ios::binary);
    std::array<std::uint8_t, 33> head{};  // the signature and the first chunk
    const auto read = [&](std::uint8_t* to, std::size_t size) {
        return static_cast<bool>(
            stream.read(reinterpret_cast<char*>(to), static_cast<std::streamsize>(size)));
    };
    const std::string_view signature("\x89PNG\r\n\x1a\n", 8);
    if (!read(head.data(), head.size()) ||
        !std::equal(signature.begin(), signature.end(), head.begin(), [](char a, std::uint8_t b) {
            return static_cast<std::uint8_t>(a) == b;
        }))
        return std::nullopt;
    if (head[25] != kWithPalette) return std::nullopt;
    std::array<std::uint8_t, 8> chunk{};
    for (int i = 0; i < kMostChunks && read(chunk.data(), chunk.size()); ++i) {
        const std::uint32_t size = std::uint32_t{chunk[0]} << 24 | std::uint32_t{chunk[1]} << 16 |
                                   std::uint32_t{chunk[2]} << 8 | chunk[3];
        const std::string_view kind(reinterpret_cast<const char*>(chunk.data()) + 4, 4);
        if (kind != "PLTE") {
            stream.seekg(std::streamoff{size} + 4, std::ios::cur);  // with its checksum
            continue;
        }
        std::array<std::uint8_t, 768> colours{};
        if (size < 3 || size > colours.size() || !read(colours.data(), size)) return std::nullopt;
        bool is_grey = true;
        for (std::size_t c = 0; c + 2 < size; c += 3)
            is_grey = is_grey && colours[c] == colours[c + 1] && colours[c + 1] == colours[c + 2];
        if (is_grey) return std::nullopt;  // such masks go by brightness
        return colour_of(colours[0], colours[1], colours[2]);
    }
    return std::nullopt;
}

// A decoded picture as labels.
class LabelPicture {
public:
    static std::optional<LabelPicture> read(const fs::path& file) {
        if (capture::is_truncated_picture(file)) return std::nullopt;
        LabelPicture picture;
        try {
            picture.pixels_ = cv::imread(file.string(), cv::IMREAD_UNCHANGED);
        } catch (const cv::Exception&) {
            return std::nullopt;
        }
        const int depth = picture.pixels_.depth();
        if (picture.pixels_.empty() || (depth != CV_8U && depth != CV_16U)) return std::nullopt;
        const auto background = background_in_palette(file);
        picture.has_palette_ = background.has_value();
        picture.background_ = background.value_or(0);
        return picture;
    }

    int width() const { return pixels_.cols; }
    int height() const { return pixels_.rows; }
    bool has_palette() const { return has_palette_; }
    Label background() const { return background_; }

    Label at(int x, int y) const {
        const int num = pixels_.channels();
        const auto sample = [&](int channel) -> Label {
            return pixels_.depth() == CV_8U ? pixels_.ptr<std::uint8_t>(y)[x * num + channel]
                                            : pixels_.ptr<std::uint16_t>(y)[x * num + channel];
        };
        if (num < 3) return colour_of(sample(0), sample(0), sample(0));
        return colour_of(sample(2), sample(1), sample(0));
    }

    // Transparency that varies tells people by itself.
    bool is_cut_out() const {
        const int num = pixels_.channels();
        if (num != 2 && num != 4) return false;
        for (int y = 0; y < height(); ++y) {
            for (int x = 0; x < width(); ++x) {
                const int at = x * num + num - 1;
                if (pixels_.depth() == CV_8U ? pixels_.ptr<std::uint8_t>(y)[at] != 0xff
                                             : pixels_.ptr<std::uint16_t>(y)[at] != 0xffff)
                    return true;
            }
        }
        return false;
    }

private:
    cv::Mat pixels_;
    bool has_palette_ = false;
    Label background_ = 0;
};

// What tells labels from shades, summed over pictures.
struct LabelCount {
    std::set<Label> labels;        // beside the background
    std::size_t most_of_one = 0;   // in one picture; more than kMostLabels: not counted further
    bool has_colour = false;       // a label is not grey
    Label brightest = 0;           // of grey labels
    bool has_other_black = false;  // a background that is not black
    bool has_palette = false;
    std::int64_t num_border = 0;
    std::int64_t num_empty_border = 0;
    std::int64_t num_neighbours = 0;  // side by side, or above each other; both in people
    std::int64_t num_equal = 0;

    void add(const LabelPicture& picture) {
        const Label background = picture.background();
        has_palette = has_palette || picture.has_palette();
        has_other_black = has_other_black || background != 0;
        std::set<Label> own;
        std::vector<Label> row(static_cast<std::size_t>(picture.width()), background);  // above
        for (int y = 0; y < picture.height() && own.size() <= kMostLabels; ++y) {
            Label left = background;
            for (int x = 0; x < picture.width(); ++x) {
                const Label label = picture.at(x, y);
                if (is_border(picture, x, y)) {
                    ++num_border;
                    num_empty_border += label == background ? 1 : 0;
                }
                Label& above = row[static_cast<std::size_t>(x)];
                if (label != background) {
                    for (const Label neighbour : {left, above}) {
                        num_neighbours += neighbour != background ? 1 : 0;
                        num_equal += neighbour == label ? 1 : 0;
                    }
                    if (label != left) note(label, own);
                }
                left = above = label;
            }
        }
        most_of_one = std::max(most_of_one, own.size());
        labels.insert(own.begin(), own.end());
    }

    bool is_too_bright() const {
        constexpr Label kByte = std::numeric_limits<std::uint8_t>::max();
        constexpr Label kTwoBytes = std::numeric_limits<std::uint16_t>::max();
        return !has_colour && !has_palette &&
               brightest > (brightest <= kByte ? kByte : kTwoBytes) / 2;
    }
    bool is_empty_at_border() const { return 2 * num_empty_border > num_border; }
    bool is_flat() const {
        return static_cast<double>(num_equal) >= kFewestEqual * static_cast<double>(num_neighbours);
    }
    bool are_labels() const {
        return most_of_one <= kMostLabels && !is_too_bright() && is_empty_at_border() && is_flat();
    }

private:
    static bool is_border(const LabelPicture& picture, int x, int y) {
        return x == 0 || y == 0 || x + 1 == picture.width() || y + 1 == picture.height();
    }
    void note(Label label, std::set<Label>& own) {
        if (!own.insert(label).second) return;
        const Label red = label >> 32;
        const Label green = label >> 16 & 0xffff;
        const Label blue = label & 0xffff;
        has_colour = has_colour || red != green || green != blue;
        brightest = std::max(brightest, green);
    }
};

// JPEG keeps no labels.
bool is_jpeg(const fs::path& file) {
    const std::string suffix = lower(file.extension().string());
    return suffix == ".jpg" || suffix == ".jpeg";
}

}  // namespace

MaskLabels find_labels(const std::vector<fs::path>& masks) {
    LabelCount count;
    for (const fs::path& mask : masks) {
        if (is_jpeg(mask)) return {};
        const auto picture = LabelPicture::read(mask);
        if (!picture) continue;  // reported elsewhere
        if (picture->is_cut_out()) return {};
        count.add(*picture);
        // as most masks are, so no more of them need be read
        if (count.is_too_bright() || count.most_of_one > kMostLabels) return {};
    }
    const bool is_needed =
        count.labels.size() >= kFewestLabels || (count.has_other_black && !count.labels.empty());
    if (!is_needed || !count.are_labels()) return {};
    return {true, count.labels.size(), count.has_palette};
}

std::string why_no_labels(const fs::path& mask) {
    const auto picture = LabelPicture::read(mask);
    if (!picture || !picture->has_palette()) return {};
    LabelCount count;
    count.add(*picture);
    if (count.most_of_one > kMostLabels)
        return fmt::format("it has more than {} colours", kMostLabels);
    if (!count.is_empty_at_border()) {
        return fmt::format(
            "the background must be the first colour of the palette, but only {} % of the border "
            "have it",
            100 * count.num_empty_border / std::max<std::int64_t>(count.num_border, 1));
    }
    if (!count.is_flat()) return "its colours change from pixel to pixel";
    return "those of other cameras are no masks of numbers";
}

Expected<image::Mask> read_mask(const fs::path& file, const MaskReading& reading) {
    image::Mask mask;
    const auto labels = reading.labels ? LabelPicture::read(file) : std::nullopt;
    if (labels) {
        // as PictureFile reads them, without an odd last row or column
        mask = image::Mask(labels->width() & ~1, labels->height() & ~1);
        for (int y = 0; y < mask.height; ++y)
            for (int x = 0; x < mask.width; ++x)
                mask.row(y)[x] = labels->at(x, y) == labels->background() ? 0 : 255;
    } else if (auto read = capture::PictureFile::of(file).read_mask(0, mask); !read) {
        return tl::unexpected(read.error());
    }
    if (reading.inverted) {
        for (std::uint8_t& value : mask.data) value = value == 0 ? 255 : 0;
    }
    return mask;
}

}  // namespace atrium::calibrate
