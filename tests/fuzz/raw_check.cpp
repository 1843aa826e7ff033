#include "site_node/capture/raw_file.hpp"
#include "tests/fuzz/file_check.hpp"

#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

namespace atrium::test {
namespace {

constexpr std::size_t kFileHead = 48;
// Larger pictures only take time.
constexpr std::size_t kMostPacked = std::size_t{1} << 20;

std::uint32_t number_at(const std::vector<std::uint8_t>& file, std::size_t at) {
    std::uint32_t value = 0;
    std::memcpy(&value, &file[at], sizeof value);
    return value;
}

void put_sum(std::vector<std::uint8_t>& file, std::size_t at, std::span<const std::uint8_t> of) {
    const std::uint64_t sum = capture::sum_of(of);
    std::memcpy(&file[at], &sum, sizeof sum);
}

void repair(std::vector<std::uint8_t>& file) {
    if (file.size() < kFileHead) return;
    const std::size_t num_codec_bytes = number_at(file, 28);
    if (num_codec_bytes > file.size() - kFileHead) return;
    put_sum(file, 32, {&file[kFileHead], num_codec_bytes});
    put_sum(file, 40, {file.data(), 40});
    std::size_t at = kFileHead + num_codec_bytes;
    while (file.size() - at >= capture::kRawRecordHeadBytes) {
        const std::size_t begin = at + capture::kRawRecordHeadBytes;
        const std::size_t num_bytes = number_at(file, at + 12);
        if (num_bytes > file.size() - begin) return;
        put_sum(file, at + 24, {file.data() + begin, num_bytes});
        put_sum(file, at + 32, {&file[at], 32});
        at = begin + num_bytes;
    }
}

// In memory, and removed with the process unless it aborts.
class RawPath {
public:
    RawPath() : path_("/dev/shm/atrium-fuzz-raw-" + std::to_string(getpid())) {}
    RawPath(const RawPath&) = delete;
    RawPath& operator=(const RawPath&) = delete;
    ~RawPath() {
        std::error_code ignored;
        std::filesystem::remove(path_, ignored);
    }
    const std::filesystem::path& get() const { return path_; }

private:
    std::filesystem::path path_;
};

}  // namespace

std::string check_raw_bytes(std::span<const std::uint8_t> bytes, bool& was_accepted) {
    static const RawPath path;
    was_accepted = false;
    if (bytes.empty()) return "";
    std::vector<std::uint8_t> content(bytes.begin() + 1, bytes.end());
    if (bytes[0] % 2 == 1) repair(content);
    std::ofstream stream(path.get(), std::ios::binary | std::ios::trunc);
    stream.write(reinterpret_cast<const char*>(content.data()),
                 static_cast<std::streamsize>(content.size()));
    if (!stream.flush()) std::abort();
    auto file = capture::RawFile::open(path.get());
    const auto names_file = [](const Error& error) {
        return error.message.find(path.get().string()) != std::string::npos;
    };
    if (!file) {
        const bool is_invalid = file.error().kind == ErrorKind::kInvalidData;
        return is_invalid && names_file(file.error()) ? "" : "another error";
    }
    const capture::RawLayout& layout = file->head().layout;
    if (!capture::is_valid(layout)) return "a layout";
    if (file->num_stored() > file->num_pictures()) return "numbers";
    if (capture::packed_bytes(layout) > kMostPacked) return "";
    std::size_t num_found = 0;
    for (std::size_t i = 0; i < file->num_pictures() && num_found < file->num_stored(); ++i) {
        if (!file->capture_time(i)) continue;
        ++num_found;
        const auto picture = file->read(i);
        if (!picture && !names_file(picture.error())) return "an error without the file";
        if (!picture) continue;
        was_accepted = true;
        if (capture::layout_of(*picture) != layout) return "a picture of another layout";
        std::vector<std::uint8_t> packed;
        capture::pack(*picture, packed);  // reads all bytes
    }
    return "";
}

}  // namespace atrium::test
