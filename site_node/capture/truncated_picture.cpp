#include "site_node/capture/truncated_picture.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <fstream>
#include <string>
#include <string_view>

namespace atrium::capture {
namespace {

constexpr std::string_view kPngBegin("\x89PNG\r\n\x1a\n", 8);
constexpr std::string_view kJpegBegin("\xff\xd8\xff", 3);
constexpr std::string_view kJpegEnd("\xff\xd9", 2);
constexpr std::streamoff kTail = 4096;  // programs append a few bytes to a JPEG
constexpr int kMaxChunks = 65'536;      // ends the walk through a hostile file

std::uint32_t big_endian(const char* bytes) {
    std::uint32_t value = 0;
    for (int i = 0; i < 4; ++i) value = value << 8U | static_cast<unsigned char>(bytes[i]);
    return value;
}

// Walks from chunk to chunk: length, name, data, checksum.
bool ends_png(std::ifstream& stream, std::streamoff num_bytes) {
    auto at = static_cast<std::streamoff>(kPngBegin.size());
    std::array<char, 8> head{};
    for (int i = 0; i < kMaxChunks; ++i) {
        if (!stream.seekg(at) || !stream.read(head.data(), head.size())) return false;
        at += std::streamoff{12} + big_endian(head.data());
        if (at > num_bytes) return false;
        if (std::string_view(head.data() + 4, 4) == "IEND") return true;
    }
    return true;
}

bool ends_jpeg(std::ifstream& stream, std::streamoff num_bytes) {
    const std::streamoff tail = std::min(kTail, num_bytes);
    std::string text(static_cast<std::size_t>(tail), '\0');
    if (!stream.seekg(num_bytes - tail) || !stream.read(text.data(), tail)) return true;
    return text.find(kJpegEnd) != std::string::npos;
}

}  // namespace

bool is_truncated_picture(const std::filesystem::path& file) {
    std::ifstream stream(file, std::ios::binary | std::ios::ate);
    if (!stream) return false;
    const std::streamoff num_bytes = stream.tellg();
    std::array<char, 8> begin{};
    stream.seekg(0);
    stream.read(begin.data(), begin.size());
    const std::string_view read(begin.data(), static_cast<std::size_t>(stream.gcount()));
    stream.clear();
    if (read.starts_with(kPngBegin)) return !ends_png(stream, num_bytes);
    if (read.starts_with(kJpegBegin)) return !ends_jpeg(stream, num_bytes);
    return false;
}

}  // namespace atrium::capture
