// Layout: ISO/IEC 14496-2, 6.2.3, video object layer.
#include "tools/calibrate/recording/codec_rate.hpp"

#include <fstream>
#include <string>
#include <string_view>

namespace atrium::calibrate {
namespace {

constexpr std::size_t kSearched = std::size_t{1} << 20;  // headers and the first picture

// Reads bits; zeros after the end.
class Bits {
public:
    explicit Bits(std::string_view bytes) : bytes_(bytes) {}
    unsigned take(unsigned num_bits) {
        unsigned value = 0;
        for (; num_bits > 0; --num_bits, ++at_) {
            const std::size_t byte = at_ / 8;
            const unsigned bit =
                byte < bytes_.size()
                    ? static_cast<unsigned char>(bytes_[byte]) >> (7 - at_ % 8) & 1U
                    : 0U;
            value = value << 1U | bit;
        }
        return value;
    }

private:
    std::string_view bytes_;
    std::size_t at_ = 0;
};

// 0 without a fixed rate.
double rate_of_layer(std::string_view bytes) {
    Bits bits(bytes);
    bits.take(1 + 8);                          // random access, type
    if (bits.take(1) == 1) bits.take(4 + 3);   // version, priority
    if (bits.take(4) == 15) bits.take(8 + 8);  // shape of a pixel
    if (bits.take(1) == 1) {                   // control parameters
        bits.take(2 + 1);                      // chroma, no B pictures
        if (bits.take(1) == 1) {               // buffer: 79 bits
            for (int i = 0; i < 79; ++i) bits.take(1);
        }
    }
    if (bits.take(2) != 0) return 0.0;  // not a rectangle
    bits.take(1);
    const unsigned ticks_per_s = bits.take(16);
    bits.take(1);
    if (bits.take(1) == 0 || ticks_per_s == 0) return 0.0;
    unsigned num_bits = 1;
    while (num_bits < 16 && 1U << num_bits < ticks_per_s) ++num_bits;
    const unsigned ticks = bits.take(num_bits);
    return ticks == 0 ? 0.0 : static_cast<double>(ticks_per_s) / ticks;
}

}  // namespace

double codec_rate_hz(const std::filesystem::path& file) {
    std::ifstream stream(file, std::ios::binary);
    std::string bytes(kSearched, '\0');
    stream.read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    bytes.resize(static_cast<std::size_t>(stream.gcount()));
    if (!bytes.starts_with("RIFF") || bytes.find("AVI ") != 8) return 0.0;
    const std::string_view all(bytes);
    const std::size_t stream_header = all.find("strh");
    if (stream_header == std::string_view::npos || stream_header + 16 > all.size()) return 0.0;
    std::string codec(all.substr(stream_header + 12, 4));
    for (char& c : codec)
        if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
    if (codec != "xvid" && codec != "divx" && codec != "dx50" && codec != "fmp4" && codec != "mp4v")
        return 0.0;
    const std::size_t pictures = all.find("movi");
    for (std::size_t at = all.find(std::string_view("\0\0\1", 3), pictures);
         at != std::string_view::npos && at + 4 < all.size();
         at = all.find(std::string_view("\0\0\1", 3), at + 3)) {
        const auto code = static_cast<unsigned char>(all[at + 3]);
        if (code >= 0x20 && code <= 0x2F) return rate_of_layer(all.substr(at + 4));
    }
    return 0.0;
}

}  // namespace atrium::calibrate
