#include "site_node/capture/picture_file.hpp"

#include "core/base/readable.hpp"
#include "site_node/capture/lost_pictures.hpp"
#include "site_node/capture/mask_values.hpp"
#include "site_node/capture/truncated_picture.hpp"
#include "site_node/capture/video_length.hpp"
#include "site_node/capture/video_rotation.hpp"

#include <fmt/format.h>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/videoio.hpp>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <fstream>
#include <limits>
#include <map>
#include <optional>
#include <string_view>
#include <system_error>

namespace atrium::capture {
namespace {

namespace fs = std::filesystem;

// A calibration is of the pixels as the camera took them, whatever orientation a JPEG claims.
constexpr int kAsStored = cv::IMREAD_COLOR | cv::IMREAD_IGNORE_ORIENTATION;
constexpr std::array kVideoSuffixes{".avi", ".mp4", ".mkv"};
constexpr std::array kImageSuffixes{".png", ".jpg", ".jpeg"};

// 000123.png -> 123; other names are not part of the sequence
std::optional<std::size_t> sequence_number(const fs::path& file) {
    const std::string stem = file.stem().string();
    const std::string suffix = file.extension().string();
    const bool is_picture =
        std::find(kImageSuffixes.begin(), kImageSuffixes.end(), suffix) != kImageSuffixes.end();
    const bool is_number =
        !stem.empty() && stem.size() <= 7 &&
        std::all_of(stem.begin(), stem.end(), [](char c) { return c >= '0' && c <= '9'; });
    if (!is_picture || !is_number) return std::nullopt;
    return static_cast<std::size_t>(std::stoul(stem));
}

// What is wrong with a file that is no picture.
std::string why_unreadable(const fs::path& file) {
    std::error_code failure;
    const auto bytes = fs::file_size(file, failure);
    if (!failure && bytes == 0) return "cannot read as a picture: the file is empty";
    if (!std::ifstream(file, std::ios::binary)) {
        const std::error_code reason(errno, std::generic_category());
        return "cannot read as a picture: " + reason.message();
    }
    if (is_truncated_picture(file)) {
        return "the file is truncated: it ends before its picture does; copy it again, or write it "
               "again";
    }
    return "cannot read as a picture: the file is damaged, or no PNG or JPEG";
}

// What is found instead of pictures with the names of a recording.
std::string why_none(const fs::path& folder, const std::string& stem) {
    std::error_code failure;
    if (!fs::is_directory(folder, failure)) {
        return fmt::format(
            "{}: no such folder, but rig.toml has a camera '{}'; copy its pictures, "
            "or remove the camera from rig.toml",
            folder.string(),
            folder.filename().string());
    }
    std::string first;  // by name
    for (const auto& entry : fs::directory_iterator(folder / stem, failure)) {
        const std::string name = entry.path().filename().string();
        if (first.empty() || name < first) first = name;
    }
    if (!first.empty()) {
        return fmt::format(
            "{}: found {}; wants 000000.png, 000001.png, ...: only the number of the instant, as "
            ".png or .jpg; `calibrate import` renumbers pictures of other names",
            (folder / stem).string(),
            first);
    }
    return fmt::format("{}: there is no {}.avi|mp4|mkv, no {}/%06d.png|jpg and no {}.png|jpg",
                       folder.string(),
                       stem,
                       stem,
                       stem);
}

// The size in the header of a PNG file, which is quicker than decoding it.
std::optional<PictureSize> size_in_png(const fs::path& file) {
    std::array<char, 24> head{};
    std::ifstream stream(file, std::ios::binary);
    const std::string_view signature("\x89PNG\r\n\x1a\n", 8);
    if (!stream.read(head.data(), head.size()) ||
        std::string_view(head.data(), signature.size()) != signature)
        return std::nullopt;
    const auto number = [&](std::size_t at) {
        std::uint32_t value = 0;
        for (std::size_t i = at; i < at + 4; ++i)
            value = value << 8 | static_cast<unsigned char>(head[i]);
        return static_cast<int>(std::min<std::uint32_t>(value, 1U << 30));
    };
    return PictureSize{number(16), number(20)};
}

}  // namespace

struct PictureFile::Impl {
    fs::path path;
    std::map<std::size_t, fs::path> images;         // empty for a video
    std::map<std::size_t, std::string> unreadable;  // reasons, by number
    cv::VideoCapture video;
    bool is_video = false;
    std::size_t num_pictures = 0;
    std::size_t num_in_header = 0;  // of a video
    LostPictures lost;              // of a video; other numbers here count without them
    std::string damage;             // of a video: why it ended early, once that is known
    std::size_t next_in_video = 0;
    bool has_failed = false;      // a picture of a video, before others
    double last_picture_s = 0.0;  // time of the picture before `next_in_video`
    cv::Mat decoded;

    // How many pictures were skipped before the video ended after `next_in_video`.
    std::size_t num_skipped() const {
        // AVI counts its pictures. MP4 also counts those that a cut hides, Matroska none; their
        // pictures have times.
        if (path.extension() == ".avi" || has_failed) return num_pictures - next_in_video;
        const double rate_hz = video.get(cv::CAP_PROP_FPS);
        const double last = std::round(last_picture_s * rate_hz);
        if (!(last >= static_cast<double>(next_in_video) &&
              last < static_cast<double>(num_pictures)))
            return 0;
        return static_cast<std::size_t>(last) + 1 - next_in_video;
    }

    Error no_frame(std::size_t index) const {
        if (!damage.empty()) return {ErrorKind::kInvalidData, damage};
        return {ErrorKind::kNotFound, fmt::format("{}: has no frame {}", path.string(), index)};
    }

    // The video has ended. Decoders skip damaged pictures, and those behind them move up.
    void note_end() {
        if (next_in_video >= num_pictures) return;
        const std::size_t num = num_skipped();
        if (num > 0) {
            damage = fmt::format(
                "{}: the video is damaged: {} of its {} pictures cannot be decoded, so pictures "
                "behind the damage are shown too early; copy or export it again",
                path.string(),
                num,
                num_pictures);
        }
        num_pictures = next_in_video;
    }

    // A picture that cannot be decoded fails like the end, but others may follow.
    bool grab() {
        constexpr std::size_t kMaxTries = 1000;
        const std::size_t num_left =
            num_pictures > next_in_video ? num_pictures - next_in_video : 1;
        std::size_t num_tries = std::min(num_left, kMaxTries);
        bool is_first = true;
        for (; !video.grab(); is_first = false)
            if (--num_tries == 0) return false;
        has_failed = has_failed || !is_first;
        last_picture_s = video.get(cv::CAP_PROP_POS_MSEC) / 1000.0;
        return true;
    }

    Expected<void> read_video(std::size_t index) {
        if (num_pictures > 0 && num_pictures < num_in_header && index >= num_pictures)
            return tl::unexpected(no_frame(index));
        if (index < next_in_video &&
            (!video.open(path.string(), cv::CAP_FFMPEG) || !video.isOpened())) {
            return make_error(ErrorKind::kInvalidData,
                              fmt::format("{}: cannot reopen", path.string()));
        }
        if (index < next_in_video) next_in_video = 0;
        // seeking by number is inexact for some codecs: frames in between are grabbed instead
        for (; next_in_video < index; ++next_in_video) {
            if (!grab()) break;
        }
        if (next_in_video != index || !grab() || !video.retrieve(decoded) || decoded.empty()) {
            if (next_in_video == 0) {
                return make_error(
                    ErrorKind::kInvalidData,
                    fmt::format("{}: cannot decode its first picture: {}",
                                path.string(),
                                is_truncated_video(path)
                                    ? kTruncatedText
                                    : "the file is damaged or empty, or of a codec that OpenCV "
                                      "cannot read here; convert it"));
            }
            note_end();
            return tl::unexpected(no_frame(index));
        }
        correct_rotation(video, decoded);
        ++next_in_video;
        return {};
    }

    Expected<void> read_image(std::size_t index, int mode) {
        const auto it = images.find(index);
        if (it == images.end()) {
            return make_error(ErrorKind::kNotFound,
                              fmt::format("{}: has no picture {}", path.string(), index));
        }
        // once: decoders print lines about bad files, and a looping recording meets them again
        const auto known = unreadable.find(index);
        if (known != unreadable.end()) return make_error(ErrorKind::kInvalidData, known->second);
        decoded = cv::Mat();
        if (!is_truncated_picture(it->second)) decoded = cv::imread(it->second.string(), mode);
        if (!decoded.empty()) return {};
        const std::string reason =
            fmt::format("{}: {}", it->second.string(), why_unreadable(it->second));
        unreadable.emplace(index, reason);
        return make_error(ErrorKind::kInvalidData, reason);
    }

    Expected<void> read(std::size_t index, int mode) {
        try {
            if (!is_video) return read_image(index, mode);
            if (lost.has(index)) {
                return make_error(
                    ErrorKind::kNotFound,
                    fmt::format("{}: the camera lost picture {}", path.string(), index));
            }
            return read_video(lost.num_before(index));
        } catch (const cv::Exception& e) {
            return make_error(ErrorKind::kInvalidData,
                              fmt::format("{}: {}", path.string(), e.what()));
        }
    }
};

PictureFile::PictureFile() : impl_(std::make_unique<Impl>()) {}
PictureFile::PictureFile(PictureFile&&) noexcept = default;
PictureFile& PictureFile::operator=(PictureFile&&) noexcept = default;
PictureFile::~PictureFile() = default;

Expected<PictureFile> PictureFile::find(const fs::path& folder, const std::string& stem) {
    PictureFile file;
    Impl& impl = *file.impl_;
    std::error_code failure;
    for (const char* suffix : kVideoSuffixes) {
        impl.path = folder / (stem + suffix);
        if (!fs::exists(impl.path, failure)) continue;
        impl.is_video = true;
        if (auto readable = check_readable(impl.path); !readable)
            return tl::unexpected(readable.error());
        if (!impl.video.open(impl.path.string(), cv::CAP_FFMPEG)) {
            return make_error(
                ErrorKind::kInvalidData,
                fmt::format("{}: cannot open as a video: {}",
                            impl.path.string(),
                            fs::is_empty(impl.path, failure) ? "the file is empty; copy it again"
                            : is_truncated_video(impl.path)
                                ? kTruncatedText
                                : "the file is damaged, or no video; copy or convert it again"));
        }
        impl.num_in_header =
            static_cast<std::size_t>(std::max(0.0, impl.video.get(cv::CAP_PROP_FRAME_COUNT)));
        impl.num_in_header = num_shown_pictures(impl.path, impl.num_in_header);
        impl.lost = lost_pictures(impl.path);
        if (impl.num_in_header >= impl.lost.num_pictures)
            impl.num_in_header -= impl.lost.numbers.size();
        impl.num_pictures = num_whole_pictures(impl.path, impl.num_in_header);
        return file;
    }
    impl.path = folder / stem;
    if (fs::is_directory(impl.path, failure)) {
        for (const auto& entry : fs::directory_iterator(impl.path, failure)) {
            if (const auto number = sequence_number(entry.path()))
                impl.images[*number] = entry.path();
        }
        if (!impl.images.empty()) impl.num_pictures = impl.images.rbegin()->first + 1;
    } else {
        for (const char* suffix : kImageSuffixes) {
            const fs::path single = folder / (stem + suffix);
            if (impl.images.empty() && fs::exists(single, failure))
                impl.images[0] = impl.path = single;
        }
        impl.num_pictures = impl.images.size();
    }
    if (impl.images.empty()) return make_error(ErrorKind::kNotFound, why_none(folder, stem));
    return file;
}

PictureFile PictureFile::of(const fs::path& picture) {
    PictureFile file;
    file.impl_->images[0] = file.impl_->path = picture;
    file.impl_->num_pictures = 1;
    return file;
}

const fs::path& PictureFile::path() const { return impl_->path; }
bool PictureFile::is_video() const { return impl_->is_video; }
std::size_t PictureFile::num_pictures() const { return impl_->lost.end_of(impl_->num_pictures); }

bool PictureFile::has_lost(std::size_t index) const { return impl_->lost.has(index); }

std::string PictureFile::what_is_missing() const {
    if (!impl_->is_video) return {};
    const std::string text =
        impl_->num_pictures < impl_->num_in_header
            ? text_of_truncated_video(impl_->num_pictures, impl_->num_in_header)
            : text_of_lost_pictures(impl_->lost);
    return text.empty() ? text : impl_->path.string() + ": " + text;
}

std::optional<PictureSize> PictureFile::size() {
    if (impl_->is_video) {
        const PictureSize size{static_cast<int>(impl_->video.get(cv::CAP_PROP_FRAME_WIDTH)),
                               static_cast<int>(impl_->video.get(cv::CAP_PROP_FRAME_HEIGHT))};
        return size.width > 0 && size.height > 0 ? std::optional(size) : std::nullopt;
    }
    const auto& [index, file] = *impl_->images.begin();
    if (const auto size = size_in_png(file)) return size;
    if (!impl_->read(index, kAsStored)) return std::nullopt;
    return PictureSize{impl_->decoded.cols, impl_->decoded.rows};
}

Expected<void> PictureFile::read(std::size_t index, image::YuvImage& out) {
    if (auto read = impl_->read(index, kAsStored); !read) return read;
    const cv::Mat& bgr = impl_->decoded;
    if (bgr.type() != CV_8UC3 || bgr.cols < 2 || bgr.rows < 2) {
        return make_error(ErrorKind::kInvalidData,
                          fmt::format("{}: not an 8-bit colour picture", path().string()));
    }
    image::yuv_from_bgr(bgr.data, bgr.cols, bgr.rows, bgr.step[0], out);
    return {};
}

PictureSize PictureFile::size_read() const { return {impl_->decoded.cols, impl_->decoded.rows}; }

std::size_t PictureFile::first_picture() const {
    return impl_->images.empty() ? 0 : impl_->images.begin()->first;
}

Expected<void> PictureFile::read_mask(std::size_t index, image::Mask& out) {
    if (auto read = impl_->read(index, cv::IMREAD_UNCHANGED); !read) return read;
    if (mask_from(impl_->decoded, out)) return {};
    return make_error(
        ErrorKind::kInvalidData,
        fmt::format("{}: not a mask: must have 1, 8 or 16 bits per channel", path().string()));
}

}  // namespace atrium::capture
