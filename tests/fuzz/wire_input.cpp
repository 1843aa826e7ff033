#include "tests/fuzz/wire_input.hpp"

#include <array>
#include <cmath>
#include <string_view>

namespace atrium::test {

void WireFiller::fill(double& value) {
    switch (reader_.below(4)) {
        case 0:
            value = 1.0;  // allowed everywhere
            break;
        case 1:
            value = reader_.between(-1.0, 1.0);
            break;
        case 2:
            value = reader_.hostile();
            break;
        default:
            // reaches both sides of any limit
            value = std::ldexp(reader_.between(-2.0, 2.0), reader_.below(64));
    }
}

void WireFiller::fill_text(atrium_Name& name, bus::Text kind_of_text) {
    if (kind_of_text == bus::Text::kNameOrNone && reader_.below(2) == 0) {
        name[0] = '\0';
        return;
    }
    constexpr std::string_view kAllowed =
        "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_.-a";
    static_assert(kAllowed.size() > 64);
    const int kind = reader_.below(4);
    if (kind == 0) {
        name[0] = 'a';
        name[1] = '\0';
        return;
    }
    const auto length = static_cast<std::size_t>(reader_.below(65));  // 64: no terminator
    for (std::size_t i = 0; i < length; ++i)
        name[i] = kind == 1 ? static_cast<char>(reader_.byte()) : kAllowed[i];
    if (length < sizeof(name)) name[length] = '\0';
    if (kind == 2 && length > 0) name[reader_.byte() % length] = static_cast<char>(reader_.byte());
}

void WireFiller::fill_text(atrium_ModelFile& file, bus::Text) {
    constexpr std::string_view kFile = "models/a.obj";
    constexpr std::string_view kParts = "a/.._m";
    const int kind = reader_.below(4);
    file[kind == 0 ? kFile.copy(file, kFile.size()) : 0] = '\0';  // 1: none
    if (kind < 2) return;
    const auto length = static_cast<std::size_t>(reader_.below(130)) % (sizeof(file) + 1);
    for (std::size_t i = 0; i < length; ++i)
        file[i] =
            kind == 2 ? kParts[reader_.byte() % kParts.size()] : static_cast<char>(reader_.byte());
    if (length < sizeof(file)) file[length] = '\0';
}

void WireFiller::fill_text(char (&line)[bus::kMaxTextLength + 1], bus::Text) {
    const bool is_printable = reader_.below(2) == 0;
    const auto length = static_cast<std::size_t>(reader_.byte()) + reader_.below(2);
    for (std::size_t i = 0; i < length; ++i)
        line[i] = static_cast<char>(is_printable ? ' ' + reader_.byte() % 95 : reader_.byte());
    if (length < sizeof(line)) line[length] = '\0';
}

void WireFiller::fill(atrium_Latency& latency) {
    fill(latency.median_ms);
    fill(latency.p99_ms);
    fill(latency.num_samples);
}

void WireFiller::fill(atrium_Pose& pose) {
    double(&rotation)[4] = pose.rotation;
    fill(pose.translation);
    switch (reader_.below(4)) {
        case 0:
            rotation[0] = rotation[1] = rotation[2] = 0.0;
            rotation[3] = 1.0;
            break;
        case 1:
            fill(rotation);
            break;
        default: {  // near the unit sphere, on both sides of the tolerance
            double squared_norm = 0.0;
            for (double& value : rotation) {
                value = reader_.between(-1.0, 1.0);
                squared_norm += value * value;
            }
            const double scale = reader_.between(0.9985, 1.0015) / std::sqrt(squared_norm);
            for (double& value : rotation) value *= scale;
        }
    }
}

std::uint64_t WireFiller::integer() {
    constexpr std::array<std::uint64_t, 14> kValues{1,
                                                    0,
                                                    2,
                                                    63,
                                                    64,
                                                    100,
                                                    16384,
                                                    16385,
                                                    0x7fffffffU,
                                                    0x80000000U,
                                                    0xffffffffU,
                                                    std::uint64_t{1} << 62U,
                                                    (std::uint64_t{1} << 62U) + 1,
                                                    ~std::uint64_t{0}};
    const auto choice = static_cast<std::size_t>(reader_.below(16));
    if (choice < kValues.size()) return kValues[choice];
    if (choice == kValues.size()) return reader_.word();
    return std::bit_cast<std::uint64_t>(reader_.raw());
}

std::size_t WireFiller::count() {
    const std::size_t choice = reader_.byte();
    if (choice < 250) return choice % 6;
    constexpr std::array<std::size_t, 6> kCounts{63, 64, 65, 2047, 2048, 2049};
    return kCounts[choice - 250];
}

}  // namespace atrium::test
