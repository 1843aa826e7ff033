#include "site_node/capture/video_length.hpp"

#include <fmt/format.h>
#include <opencv2/videoio.hpp>

extern "C" {
#include <libavformat/avformat.h>
}

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <fstream>
#include <memory>
#include <optional>
#include <string_view>

namespace atrium::capture {
namespace {

constexpr int kMaxParts = 65'536;  // ends the walk through a hostile file
constexpr std::size_t kHeadBytes = 32;

// The first bytes at a place of a file; zeros behind its end.
class Head {
public:
    Head(std::ifstream& stream, std::uint64_t at) {
        stream.clear();
        stream.seekg(static_cast<std::streamoff>(at));
        stream.read(bytes_.data(), bytes_.size());
    }
    std::string_view text(std::size_t at, std::size_t size) const {
        return std::string_view(bytes_.data(), bytes_.size()).substr(at, size);
    }
    std::uint64_t byte(std::size_t at) const { return static_cast<unsigned char>(bytes_[at]); }
    std::uint64_t big_endian(std::size_t at, std::size_t size) const {
        std::uint64_t value = 0;
        for (std::size_t i = 0; i < size; ++i) value = value << 8U | byte(at + i);
        return value;
    }
    std::uint64_t little_endian_32(std::size_t at) const {
        return byte(at) | byte(at + 1) << 8U | byte(at + 2) << 16U | byte(at + 3) << 24U;
    }

private:
    std::array<char, kHeadBytes> bytes_{};
};

// End of a chunk at the top of an AVI file. Recorders that crashed leave sizes of 0.
std::optional<std::uint64_t> end_of_riff(const Head& head, std::uint64_t at) {
    if (head.text(0, 4) != "RIFF") return std::nullopt;
    const std::uint64_t size = head.little_endian_32(4);
    return size == 0 ? std::nullopt : std::optional(at + 8 + size);
}

std::optional<std::uint64_t> end_of_box(const Head& head, std::uint64_t at) {
    std::uint64_t size = head.big_endian(0, 4);
    if (size == 1) size = head.big_endian(8, 8);
    // 0: to the end of the file
    if (size < 8 || size > std::uint64_t{1} << 60) return std::nullopt;
    return at + size;
}

// End of an element of Matroska: an ID, a size, both of variable length, and the content.
std::optional<std::uint64_t> end_of_element(const Head& head, std::uint64_t at) {
    const auto length_at = [&](std::size_t place) {
        return static_cast<std::size_t>(
            std::countl_zero(static_cast<unsigned char>(head.byte(place))) + 1);
    };
    const std::size_t id_bytes = length_at(0);
    if (id_bytes > 4) return std::nullopt;
    const std::size_t size_bytes = length_at(id_bytes);
    if (size_bytes > 8) return std::nullopt;
    const std::uint64_t all_ones = (std::uint64_t{1} << (7 * size_bytes)) - 1;
    const std::uint64_t size = head.big_endian(id_bytes, size_bytes) & all_ones;
    // all ones: unknown
    return size == all_ones ? std::nullopt : std::optional(at + id_bytes + size_bytes + size);
}

using EndOf = std::optional<std::uint64_t> (*)(const Head&, std::uint64_t);

EndOf container_of(const Head& head) {
    if (head.text(0, 4) == "RIFF" && head.text(8, 4) == "AVI ") return end_of_riff;
    if (head.text(0, 4) == "\x1A\x45\xDF\xA3") return end_of_element;
    constexpr std::array<std::string_view, 4> kFirstBoxes{"ftyp", "moov", "mdat", "wide"};
    if (std::ranges::find(kFirstBoxes, head.text(4, 4)) != kFirstBoxes.end()) return end_of_box;
    return nullptr;
}

// Reads the whole file, but decodes nothing. 0 if it cannot be opened.
std::size_t num_compressed_pictures(const std::filesystem::path& file) try {
    cv::VideoCapture video(file.string(), cv::CAP_FFMPEG);
    video.set(cv::CAP_PROP_FORMAT, -1);  // compressed
    std::size_t number = 0;
    while (video.grab()) ++number;
    return number;
} catch (const cv::Exception&) {
    return 0;
}

struct CloseInput {
    void operator()(AVFormatContext* input) const { avformat_close_input(&input); }
};

}  // namespace

std::size_t num_shown_pictures(const std::filesystem::path& file, std::size_t in_header) {
    std::ifstream stream(file, std::ios::binary);
    if (!stream || container_of(Head(stream, 0)) != end_of_box) return in_header;
    AVFormatContext* opened = nullptr;
    if (avformat_open_input(&opened, file.c_str(), nullptr, nullptr) < 0) return in_header;
    const std::unique_ptr<AVFormatContext, CloseInput> input(opened);
    for (unsigned i = 0; i < input->nb_streams; ++i) {
        AVStream* const pictures = input->streams[i];
        if (pictures->codecpar->codec_type != AVMEDIA_TYPE_VIDEO) continue;
        // without a number, the file is in fragments, whose index is not read yet
        const int num_entries = avformat_index_get_entries_count(pictures);
        if (pictures->nb_frames <= 0 || num_entries <= 0) return in_header;
        std::size_t num_shown = 0;
        for (int entry = 0; entry < num_entries; ++entry) {
            const int flags = avformat_index_get_entry(pictures, entry)->flags;
            num_shown += (flags & AVINDEX_DISCARD_FRAME) == 0 ? 1 : 0;
        }
        return num_shown == 0 ? in_header : std::min(num_shown, in_header);
    }
    return in_header;
}

bool is_truncated_video(const std::filesystem::path& file) {
    std::ifstream stream(file, std::ios::binary | std::ios::ate);
    if (!stream) return false;
    const auto num_bytes = static_cast<std::uint64_t>(stream.tellg());
    const EndOf end_of = container_of(Head(stream, 0));
    if (end_of == nullptr) return false;
    std::uint64_t at = 0;
    for (int i = 0; i < kMaxParts && at < num_bytes; ++i) {
        const auto end = end_of(Head(stream, at), at);
        if (!end) return false;
        at = *end;
    }
    return at > num_bytes + 1;  // a last byte of padding may be missing
}

std::size_t num_whole_pictures(const std::filesystem::path& file, std::size_t in_header) {
    if (!is_truncated_video(file)) return in_header;
    const std::size_t found = num_compressed_pictures(file);
    if (found == 0 || found >= in_header) return in_header;
    return std::max<std::size_t>(found - 1, 1);  // the last one is cut
}

std::string text_of_truncated_video(std::size_t num_whole, std::size_t in_header) {
    return fmt::format(
        "the video ends after picture {} of {}: {}", num_whole, in_header, kTruncatedText);
}

}  // namespace atrium::capture
