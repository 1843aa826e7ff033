#include "site_node/segmentation/background_file.hpp"

#include "core/base/fnv1a.hpp"

#include <unistd.h>

#include <array>
#include <cstring>
#include <fstream>
#include <string_view>
#include <system_error>

namespace atrium::segmentation {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kMagic = "ATRIUMBG";
constexpr std::uint32_t kVersion = 1;
constexpr std::uint32_t kVersionHadPeople = 2;
constexpr std::uint32_t kMaxSize_px = 8192;
constexpr std::uint32_t kMaxName = 63;

std::uint64_t checksum(const std::vector<char>& bytes, std::size_t size) {
    return fnv1a<char>({bytes.data(), size});
}

template <typename Value>
void append(std::vector<char>& bytes, const Value& value) {
    const std::size_t at = bytes.size();
    bytes.resize(at + sizeof value);
    std::memcpy(bytes.data() + at, &value, sizeof value);
}

template <typename Value>
void append(std::vector<char>& bytes, const std::vector<Value>& plane) {
    const std::size_t at = bytes.size();
    bytes.resize(at + plane.size() * sizeof(Value));
    std::memcpy(bytes.data() + at, plane.data(), plane.size() * sizeof(Value));
}

// Reads untrusted bytes: past their end every value is 0 and `failed` is true.
class ByteReader {
public:
    explicit ByteReader(const std::vector<char>& bytes, std::size_t size)
        : bytes_(bytes), size_(size) {}

    template <typename Value>
    Value value() {
        Value result{};
        take(&result, sizeof result);
        return result;
    }

    std::string text(std::size_t length) {
        std::string result(length, '\0');
        take(result.data(), length);
        return result;
    }

    template <typename Value>
    void plane(std::size_t length, std::vector<Value>& result) {
        if (failed_ || (size_ - at_) / sizeof(Value) < length) {
            failed_ = true;
            return;
        }
        result.resize(length);
        take(result.data(), length * sizeof(Value));
    }

    bool failed() const { return failed_; }
    bool at_end() const { return !failed_ && at_ == size_; }

private:
    void take(void* target, std::size_t size) {
        failed_ = failed_ || size_ - at_ < size;
        if (failed_ || size == 0) return;
        std::memcpy(target, bytes_.data() + at_, size);
        at_ += size;
    }

    const std::vector<char>& bytes_;
    std::size_t size_;
    std::size_t at_ = 0;
    bool failed_ = false;
};

std::vector<char> to_bytes(const BackgroundStatistics& room, const std::string& camera) {
    std::vector<char> bytes(kMagic.begin(), kMagic.end());
    append(bytes, room.had_people ? kVersionHadPeople : kVersion);
    append(bytes, static_cast<std::uint32_t>(camera.size()));
    bytes.insert(bytes.end(), camera.begin(), camera.end());
    append(bytes, static_cast<std::uint32_t>(room.width));
    append(bytes, static_cast<std::uint32_t>(room.height));
    append(bytes, static_cast<std::uint32_t>(room.mosaic));
    append(bytes, static_cast<std::uint32_t>(room.num_frames));
    append(bytes, room.luma);
    append(bytes, room.luma_sigma);
    for (const auto* plane : {&room.u, &room.v, &room.uu, &room.uv, &room.vv})
        append(bytes, *plane);
    append(bytes, checksum(bytes, bytes.size()));
    return bytes;
}

// Returns what is wrong; empty if nothing.
std::string from_bytes(const std::vector<char>& bytes,
                       const std::string& camera,
                       BackgroundStatistics& room) {
    if (bytes.size() < sizeof(std::uint64_t)) return "is truncated";
    const std::size_t size = bytes.size() - sizeof(std::uint64_t);
    ByteReader reader(bytes, size);
    if (reader.text(kMagic.size()) != kMagic) return "is not a background file";
    const auto version = reader.value<std::uint32_t>();
    if (version != kVersion && version != kVersionHadPeople) {
        return "has version " + std::to_string(version) + ", not " + std::to_string(kVersion) +
               " or " + std::to_string(kVersionHadPeople);
    }
    std::uint64_t sum = 0;
    std::memcpy(&sum, bytes.data() + size, sizeof sum);
    if (sum != checksum(bytes, size)) return "is damaged or truncated";
    const auto length = reader.value<std::uint32_t>();
    if (length > kMaxName) return "is damaged";
    if (const std::string name = reader.text(length); name != camera)
        return "belongs to camera '" + name + "'";
    const auto width = reader.value<std::uint32_t>();
    const auto height = reader.value<std::uint32_t>();
    const auto mosaic = reader.value<std::uint32_t>();
    const auto num_frames = reader.value<std::uint32_t>();
    if (width < 2 || height < 2 || width > kMaxSize_px || height > kMaxSize_px || width % 2 != 0 ||
        height % 2 != 0 || mosaic > static_cast<std::uint32_t>(image::Mosaic::kBG) ||
        num_frames == 0 || num_frames > 1'000'000) {
        return "is damaged";
    }
    room.width = static_cast<int>(width);
    room.height = static_cast<int>(height);
    room.mosaic = static_cast<image::Mosaic>(mosaic);
    room.num_frames = static_cast<int>(num_frames);
    room.had_people = version == kVersionHadPeople;
    const std::size_t num_pixels = static_cast<std::size_t>(width) * height;
    reader.plane(num_pixels, room.luma);
    reader.plane(num_pixels, room.luma_sigma);
    for (auto* plane : {&room.u, &room.v, &room.uu, &room.uv, &room.vv})
        reader.plane(num_pixels / 4, *plane);
    return reader.at_end() ? "" : "does not have the length that its picture size requires";
}

}  // namespace

fs::path background_file(const fs::path& folder, const std::string& camera) {
    return folder / (camera + ".background");
}

Expected<void> save_background(const BackgroundStatistics& room,
                               const fs::path& folder,
                               const std::string& camera) {
    const fs::path file = background_file(folder, camera);
    std::error_code problem;
    fs::create_directories(folder, problem);
    if (problem) {
        return make_error(ErrorKind::kUnavailable,
                          folder.string() + ": cannot create: " + problem.message());
    }
    const std::vector<char> bytes = to_bytes(room, camera);
    const fs::path temporary = file.string() + ".part" + std::to_string(getpid());
    {
        std::ofstream stream(temporary, std::ios::binary);
        stream.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
        stream.close();
        if (!stream) problem = std::make_error_code(std::errc::io_error);
    }
    if (!problem) fs::rename(temporary, file, problem);
    if (problem) {
        std::error_code ignored;
        fs::remove(temporary, ignored);
        return make_error(ErrorKind::kUnavailable,
                          file.string() + ": cannot write: " + problem.message());
    }
    return {};
}

Expected<BackgroundStatistics> load_background(const fs::path& folder, const std::string& camera) {
    const fs::path file = background_file(folder, camera);
    std::error_code problem;
    const auto size = fs::file_size(file, problem);
    std::ifstream stream(file, std::ios::binary);
    if (problem == std::errc::no_such_file_or_directory)
        return make_error(ErrorKind::kNotFound, file.string() + ": does not exist");
    if (problem || !stream)
        return make_error(ErrorKind::kInvalidData, file.string() + ": cannot read");
    // upper limit: 11/2 bytes per pixel plus a header
    constexpr std::uintmax_t kMaxBytes = 6ULL * kMaxSize_px * kMaxSize_px;
    if (size > kMaxBytes)
        return make_error(ErrorKind::kInvalidData, file.string() + ": is too long");
    std::vector<char> bytes(static_cast<std::size_t>(size));
    stream.read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    if (!stream) return make_error(ErrorKind::kInvalidData, file.string() + ": cannot read");
    BackgroundStatistics room;
    if (const std::string wrong = from_bytes(bytes, camera, room); !wrong.empty())
        return make_error(ErrorKind::kInvalidData,
                          file.string() + ": " + wrong + "; run --learn-background again");
    return room;
}

}  // namespace atrium::segmentation
