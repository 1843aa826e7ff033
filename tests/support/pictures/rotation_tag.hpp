#pragma once

#include <gtest/gtest.h>

#include <array>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

namespace atrium::test {

/// Says in an MP4 file with one track that players turn its pictures clockwise by 90, 180 or 270
/// degrees, as phones do (ISO/IEC 14496-12, the matrix of a track header of version 0).
inline void set_rotation_tag(const std::filesystem::path& file, int clockwise_deg) {
    std::string bytes;
    {
        std::ifstream in(file, std::ios::binary);
        bytes.assign(std::istreambuf_iterator<char>(in), {});
    }
    const std::size_t header = bytes.find("tkhd");
    ASSERT_NE(header, std::string::npos);
    ASSERT_EQ(bytes.at(header + 4), 0) << "another version of the header";
    constexpr std::uint32_t kOne = 1U << 16;
    constexpr std::uint32_t kMinusOne = 0U - kOne;
    // x' = a x + c y, y' = b x + d y, with y downwards
    const std::array<std::uint32_t, 5> rows =
        clockwise_deg == 90    ? std::array<std::uint32_t, 5>{0, kOne, 0, kMinusOne, 0}
        : clockwise_deg == 180 ? std::array<std::uint32_t, 5>{kMinusOne, 0, 0, 0, kMinusOne}
                               : std::array<std::uint32_t, 5>{0, kMinusOne, 0, kOne, 0};
    for (std::size_t i = 0; i < rows.size(); ++i)
        for (std::size_t byte = 0; byte < 4; ++byte)
            bytes.at(header + 44 + 4 * i + byte) =
                static_cast<char>(rows.at(i) >> (24 - 8 * byte) & 0xFFU);
    std::ofstream(file, std::ios::binary) << bytes;
}

}  // namespace atrium::test
