#include "viewer/scene/texture_library.hpp"

#include "core/app/log.hpp"
#include "core/base/readable.hpp"
#include "core/bus/names.hpp"
#include "viewer/scene/file_advice.hpp"

#include <fmt/format.h>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include <algorithm>
#include <fstream>
#include <optional>
#include <span>
#include <system_error>
#include <utility>

namespace atrium::viewer {
namespace {

constexpr const char* kUseFewer = "use fewer or smaller textures";

using Bytes = std::span<const std::uint8_t>;

struct PictureSize {
    std::uint32_t width = 0;
    std::uint32_t height = 0;
};

std::uint32_t big_endian(Bytes bytes) {
    std::uint32_t value = 0;
    for (const std::uint8_t byte : bytes) value = value << 8U | byte;
    return value;
}

// Reads the size from the header chunk that every PNG begins with.
std::optional<PictureSize> size_of_png(Bytes bytes) {
    constexpr std::uint8_t kSignature[] = {0x89, 'P', 'N', 'G', 0x0D, 0x0A, 0x1A, 0x0A};
    if (bytes.size() < 24 ||
        !std::equal(std::begin(kSignature), std::end(kSignature), bytes.data()))
        return std::nullopt;
    return PictureSize{big_endian(bytes.subspan(16, 4)), big_endian(bytes.subspan(20, 4))};
}

// Reads the size from the frame header; skips the segments before it.
std::optional<PictureSize> size_of_jpeg(Bytes bytes) {
    if (bytes.size() < 4 || bytes[0] != 0xFF || bytes[1] != 0xD8) return std::nullopt;
    std::size_t at = 2;
    while (at + 9 <= bytes.size() && bytes[at] == 0xFF) {
        const std::uint8_t marker = bytes[at + 1];
        const bool is_frame =
            marker >= 0xC0 && marker <= 0xCF && marker != 0xC4 && marker != 0xC8 && marker != 0xCC;
        if (is_frame)
            return PictureSize{big_endian(bytes.subspan(at + 7, 2)),
                               big_endian(bytes.subspan(at + 5, 2))};
        at += marker == 0xFF ? 1 : 2 + std::size_t{big_endian(bytes.subspan(at + 2, 2))};
    }
    return std::nullopt;
}

Expected<std::vector<std::uint8_t>> bytes_of(const std::filesystem::path& file,
                                             std::uintmax_t max_bytes) {
    if (const auto readable = check_readable(file); !readable)
        return tl::unexpected(readable.error());
    std::error_code failure;
    const std::uintmax_t num_bytes = std::filesystem::file_size(file, failure);
    if (failure || num_bytes > max_bytes) {
        return make_error(
            ErrorKind::kInvalidData,
            fmt::format(
                "{}: exceeds the limit of {} bytes for a texture", file.string(), max_bytes));
    }
    std::vector<std::uint8_t> bytes(num_bytes);
    std::ifstream stream(file, std::ios::binary);
    stream.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(num_bytes));
    if (static_cast<std::uintmax_t>(stream.gcount()) != num_bytes)
        return make_error(ErrorKind::kNotFound, fmt::format("{}: cannot be read", file.string()));
    return bytes;
}

cv::Mat decode(const std::vector<std::uint8_t>& bytes) {
    try {
        cv::Mat picture = cv::imdecode(bytes, cv::IMREAD_UNCHANGED);
        if (picture.depth() == CV_16U) picture.convertTo(picture, CV_8U, 1.0 / 257.0);
        cv::Mat rgba;
        if (picture.type() == CV_8UC1) cv::cvtColor(picture, rgba, cv::COLOR_GRAY2RGBA);
        if (picture.type() == CV_8UC3) cv::cvtColor(picture, rgba, cv::COLOR_BGR2RGBA);
        if (picture.type() == CV_8UC4) cv::cvtColor(picture, rgba, cv::COLOR_BGRA2RGBA);
        return rgba;
    } catch (const cv::Exception&) {
        return {};  // damaged, as if nothing was decoded
    }
}

}  // namespace

Expected<renderer::TexturePicture> read_texture(const std::filesystem::path& file,
                                                const TextureLimits& limits,
                                                FilesRead* read) {
    if (read != nullptr) *read = {{}, {{file, file_stamp(file)}}};
    const auto bytes = bytes_of(file, limits.max_file_bytes);
    if (!bytes) return tl::unexpected(bytes.error());
    if (read != nullptr) read->fingerprint = fingerprint_of(*bytes);
    const auto invalid = [&](const std::string& what) {
        return make_error(ErrorKind::kInvalidData, fmt::format("{}: {}", file.string(), what));
    };
    auto size = size_of_png(*bytes);
    if (!size) size = size_of_jpeg(*bytes);
    if (!size) return invalid("is neither a PNG nor a JPEG picture");
    const auto max_px = static_cast<std::uint32_t>(limits.max_side_px);
    if (size->width < 1 || size->height < 1 || size->width > max_px || size->height > max_px) {
        return invalid(fmt::format("has {} x {} pixels; a texture needs 1 to {} pixels per side",
                                   size->width,
                                   size->height,
                                   max_px));
    }
    const cv::Mat rgba = decode(*bytes);
    if (rgba.empty() || static_cast<std::uint32_t>(rgba.cols) > max_px ||
        static_cast<std::uint32_t>(rgba.rows) > max_px)
        return invalid("is damaged");
    renderer::TexturePicture picture{.width = rgba.cols, .height = rgba.rows, .rgba = {}};
    picture.rgba.assign(rgba.data, rgba.data + rgba.total() * rgba.elemSize());
    return picture;
}

TextureLibrary::TextureLibrary(const std::filesystem::path& folder, const TextureLimits& limits)
    : folder_(folder),
      limits_(limits),
      versions_(limits.max_textures),
      reader_([folder, limits, all = std::map<std::string, FilesRead>()](
                  const Request& request) mutable -> Expected<Read> {
          FilesRead& files = all[request.file];
          if (request.is_check && !files.have_changed()) return Read{};
          auto picture = read_texture(folder / request.file, limits, &files);
          if (!picture) return tl::unexpected(picture.error());
          return Read{std::move(*picture), files.fingerprint};
      }) {}

void TextureLibrary::expect(const std::string& file, const Fingerprint& of_server) {
    versions_.expect(file, of_server);
}

void TextureLibrary::want(const std::string& file) {
    // the bus has checked the name; it cannot leave the folder
    if (!bus::is_valid_model_file(file) || reader_.is_wanted({file, false})) return;
    const std::size_t num_wanted = versions_.num_read();
    if (num_wanted >= limits_.max_textures)
        return complain(file, fmt::format("the limit is {} textures", num_wanted), kUseFewer);
    versions_.begin(key_of(file), FileVersions::Clock::now());
    reader_.want({file, false});
}

std::vector<TextureLibrary::Loaded> TextureLibrary::take(FileVersions::Clock::time_point now) {
    std::vector<Loaded> loaded;
    for (auto& [request, read] : reader_.take()) take(request, std::move(read), loaded);
    for (const auto& [file, scale] : versions_.take_due(now)) reader_.want_again({file, true});
    return loaded;
}

void TextureLibrary::take(const Request& request,
                          Expected<Read> read,
                          std::vector<Loaded>& loaded) {
    const auto& [file, is_check] = request;
    const auto known = num_pixels_.find(file);
    const std::size_t num_before = known == num_pixels_.end() ? 0 : known->second;
    // a file that is being copied here cannot be read yet: the texture before stays
    const bool keeps = is_check && (read ? !read->picture : num_before > 0);
    std::optional<Fingerprint> own;
    if (!keeps) own = read ? read->fingerprint : Fingerprint{};
    if (versions_.end(key_of(file), own))
        app::log::warn("{}", differs_line("texture", file, folder_));
    if (keeps) return;
    if (!read) {
        return complain(file,
                        read.error().message,
                        advice_about(read.error(), folder_, file, "save it again as PNG or JPEG"));
    }
    const std::size_t num_pixels = read->picture->rgba.size() / 4;
    if (num_all_pixels_ - num_before + num_pixels > limits_.max_pixels) {
        return complain(
            file,
            fmt::format("all textures together exceed the limit of {} pixels", limits_.max_pixels),
            kUseFewer);
    }
    num_all_pixels_ += num_pixels - num_before;
    num_pixels_[file] = num_pixels;
    missing_.erase(file);
    loaded.emplace_back(file, std::move(*read->picture));
}

void TextureLibrary::forget() {
    reader_.forget();
    versions_.forget();
    missing_.clear();
    num_pixels_.clear();
    num_all_pixels_ = 0;
}

// Warns once per file.
void TextureLibrary::complain(const std::string& file,
                              const std::string& why,
                              const std::string& advice) {
    if (missing_.size() < limits_.max_textures) missing_.insert(file);
    if (complained_.size() >= limits_.max_textures || !complained_.insert(file).second) return;
    app::log::warn("texture_missing {}: {}; drawn in its plain colour; {}", file, why, advice);
}

}  // namespace atrium::viewer
