#include "site_node/record/camera_file.hpp"

#include "tests/unit/record/raw_pictures.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cerrno>
#include <fstream>
#include <iterator>

namespace atrium::record {
namespace {

namespace fs = std::filesystem;
using capture::RawCodec;
using capture::RawFile;
using image::PixelFormat;
using test::bytes_of;
using test::make_picture;
using testing::HasSubstr;

std::vector<std::uint8_t> packed(const image::RawImage& picture) {
    std::vector<std::uint8_t> bytes;
    capture::pack(picture, bytes);
    return bytes;
}

class CameraFileOnDisk : public test::OwnFolder {
protected:
    fs::path file_ = folder_ / "frames.raw";

    // Pictures 0, 1, ... of one format, at 100 ns, 200 ns, ...
    void write_pictures(PixelFormat format, RawCodec codec, int num, int side_px = 16) {
        fs::remove(file_);
        auto file = CameraFile::create(file_, {format, side_px, side_px}, codec, system_calls());
        ASSERT_TRUE(file) << file.error().message;
        for (int i = 0; i < num; ++i) {
            const auto number = static_cast<std::uint64_t>(i);
            ASSERT_TRUE(file->append(
                number, {100 * (i + 1)}, packed(make_picture(format, side_px, side_px, number))));
        }
    }

    std::vector<char> content() const {
        std::ifstream stream(file_, std::ios::binary);
        return {std::istreambuf_iterator<char>(stream), {}};
    }
    void set_content(const std::vector<char>& bytes) const {
        std::ofstream stream(file_, std::ios::binary | std::ios::trunc);
        stream.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    }
};

TEST_F(CameraFileOnDisk, GivesEveryPixelFormatBackBitForBitWithEveryCodec) {
    for (const RawCodec codec : {RawCodec::kRaw, RawCodec::kHuffYuv, RawCodec::kFfv1}) {
        for (const PixelFormat format : test::all_formats()) {
            SCOPED_TRACE(std::string(name_of(codec)) + ", format " +
                         std::to_string(static_cast<int>(format)));
            // odd sizes, except where formats have none
            const bool is_even = format == PixelFormat::kYuv420;
            const int width = is_even ? 46 : 47, height = is_even ? 34 : 35;
            fs::remove(file_);
            auto file = CameraFile::create(file_, {format, width, height}, codec, system_calls());
            ASSERT_TRUE(file) << file.error().message;
            for (std::uint64_t i = 0; i < 3; ++i) {
                const auto time = Timestamp{1'700'000'000'000'000'000 + static_cast<int>(i)};
                ASSERT_TRUE(file->append(i, time, packed(make_picture(format, width, height, i))));
            }
            auto read = RawFile::open(file_);
            ASSERT_TRUE(read) << read.error().message;
            EXPECT_EQ(read->num_pictures(), 3u);
            EXPECT_EQ(read->damage(), "");
            for (const std::uint64_t i : {2U, 0U, 1U}) {  // in any order
                const auto picture = read->read(i);
                ASSERT_TRUE(picture) << picture.error().message;
                EXPECT_EQ(picture->format, format);
                EXPECT_EQ(picture->width, width);
                EXPECT_EQ(picture->height, height);
                EXPECT_EQ(bytes_of(*picture), bytes_of(make_picture(format, width, height, i)));
                EXPECT_EQ(read->capture_time(i)->ns,
                          1'700'000'000'000'000'000 + static_cast<int>(i));
            }
        }
    }
}

TEST_F(CameraFileOnDisk, CompressesPicturesAndStoresNoiseAsItIs) {
    const capture::RawLayout layout{PixelFormat::kBayerRG, 256, 256};
    for (const RawCodec codec : {RawCodec::kHuffYuv, RawCodec::kFfv1}) {
        fs::remove(file_);
        auto file = CameraFile::create(file_, layout, codec, system_calls());
        ASSERT_TRUE(file) << file.error().message;
        const auto soft = packed(make_picture(layout.format, 256, 256, 1));
        const auto soft_bytes = file->append(0, {}, soft);
        ASSERT_TRUE(soft_bytes);
        EXPECT_LT(*soft_bytes, soft.size() * 6 / 10);
        atrium::test::Random random(1);
        std::vector<std::uint8_t> noise(soft.size());
        for (std::uint8_t& byte : noise)
            byte = static_cast<std::uint8_t>(atrium::test::between(random, 0, 255));
        const auto noise_bytes = file->append(1, {}, noise);
        ASSERT_TRUE(noise_bytes);
        EXPECT_EQ(*noise_bytes, noise.size() + capture::kRawRecordHeadBytes);
        auto read = RawFile::open(file_);
        ASSERT_TRUE(read);
        EXPECT_EQ(bytes_of(*read->read(1)), noise);
        EXPECT_EQ(bytes_of(*read->read(0)), soft);
    }
}

TEST_F(CameraFileOnDisk, KnowsWhichNumbersAreMissing) {
    auto file =
        CameraFile::create(file_, {PixelFormat::kMono8, 16, 16}, RawCodec::kRaw, system_calls());
    ASSERT_TRUE(file);
    for (const std::uint64_t number : {2U, 3U, 7U})
        ASSERT_TRUE(file->append(number, {}, packed(make_picture(PixelFormat::kMono8, 16, 16, 1))));
    auto read = RawFile::open(file_);
    ASSERT_TRUE(read);
    EXPECT_EQ(read->num_pictures(), 8u);
    EXPECT_EQ(read->num_stored(), 3u);
    EXPECT_TRUE(read->read(3));
    EXPECT_EQ(read->read(4).error().kind, ErrorKind::kNotFound);
    EXPECT_FALSE(read->capture_time(4));
}

TEST_F(CameraFileOnDisk, PlaysAllWholePicturesOfAFileCutOffAnywhere) {
    for (const RawCodec codec : {RawCodec::kRaw, RawCodec::kHuffYuv, RawCodec::kFfv1}) {
        write_pictures(PixelFormat::kBayerGR, codec, 4);
        const std::vector<char> whole = content();
        std::vector<std::size_t> ends;  // of the head and of each picture
        for (int num = 0; num <= 4; ++num) {
            write_pictures(PixelFormat::kBayerGR, codec, num);
            ends.push_back(content().size());
        }
        ASSERT_EQ(ends.back(), whole.size());
        for (std::size_t size = 0; size <= whole.size(); ++size) {
            SCOPED_TRACE(size);
            set_content({whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(size)});
            auto read = RawFile::open(file_);
            if (size < ends.front()) {
                ASSERT_FALSE(read);
                EXPECT_EQ(read.error().kind, ErrorKind::kInvalidData);
                continue;
            }
            ASSERT_TRUE(read) << read.error().message;
            const auto num_whole = static_cast<std::size_t>(
                std::upper_bound(ends.begin(), ends.end(), size) - ends.begin() - 1);
            ASSERT_EQ(read->num_pictures(), num_whole);
            EXPECT_EQ(read->damage().empty(), size == ends[num_whole]);
            for (std::size_t i = 0; i < num_whole; ++i) {
                const auto picture = read->read(i);
                ASSERT_TRUE(picture) << picture.error().message;
                EXPECT_EQ(bytes_of(*picture),
                          bytes_of(make_picture(PixelFormat::kBayerGR, 16, 16, i)));
            }
        }
    }
}

TEST_F(CameraFileOnDisk, NeverGivesAWrongPictureFromADamagedFile) {
    for (const RawCodec codec : {RawCodec::kRaw, RawCodec::kHuffYuv, RawCodec::kFfv1}) {
        write_pictures(PixelFormat::kYuv420, codec, 2);
        const std::vector<char> whole = content();
        for (std::size_t at = 0; at < whole.size(); ++at) {
            SCOPED_TRACE(at);
            std::vector<char> damaged = whole;
            damaged[at] = static_cast<char>(damaged[at] ^ (1 << (at % 8)));
            set_content(damaged);
            auto read = RawFile::open(file_);
            if (!read) continue;
            EXPECT_TRUE(read->num_stored() < 2 || !read->read(0) || !read->read(1));
            for (std::size_t i = 0; i < 2; ++i) {
                const auto picture = read->read(i);
                if (!picture) continue;
                EXPECT_EQ(bytes_of(*picture),
                          bytes_of(make_picture(PixelFormat::kYuv420, 16, 16, i)));
            }
        }
    }
}

TEST_F(CameraFileOnDisk, EndsWithAWholePictureWhenTheDiskIsFull) {
    std::size_t num_left = 1500;  // bytes
    FileCalls calls = system_calls();
    calls.write = [&](int file, const iovec* parts, int num_parts) -> ssize_t {
        // short writes, then none
        for (int i = 0; i < num_parts; ++i) {
            const std::size_t num = std::min({parts[i].iov_len, num_left, std::size_t{100}});
            if (num == 0) continue;
            num_left -= num;
            return ::write(file, parts[i].iov_base, num);
        }
        errno = ENOSPC;
        return -1;
    };
    auto file = CameraFile::create(file_, {PixelFormat::kMono8, 20, 20}, RawCodec::kRaw, calls);
    ASSERT_TRUE(file);
    std::uint64_t num_written = 0;
    Expected<std::uint64_t> appended;
    do {
        appended = file->append(
            num_written, {}, packed(make_picture(PixelFormat::kMono8, 20, 20, num_written)));
        if (appended) ++num_written;
    } while (appended);
    EXPECT_EQ(num_written, 3u);  // of 440 bytes each
    EXPECT_THAT(appended.error().message, HasSubstr("No space left"));
    auto read = RawFile::open(file_);
    ASSERT_TRUE(read);
    EXPECT_EQ(read->num_pictures(), 3u);
    EXPECT_EQ(read->damage(), "");
}

TEST_F(CameraFileOnDisk, RefusesToReplaceAFile) {
    write_pictures(PixelFormat::kMono8, RawCodec::kRaw, 1);
    const auto again =
        CameraFile::create(file_, {PixelFormat::kMono8, 16, 16}, RawCodec::kRaw, system_calls());
    ASSERT_FALSE(again);
    EXPECT_THAT(again.error().message, HasSubstr("File exists"));
    EXPECT_EQ(RawFile::open(file_)->num_pictures(), 1u);
}

TEST_F(CameraFileOnDisk, NamesOtherFiles) {
    set_content({'R', 'I', 'F', 'F'});
    EXPECT_THAT(RawFile::open(file_).error().message, HasSubstr("ends before its first picture"));
    set_content(std::vector<char>(100, 'x'));
    EXPECT_THAT(RawFile::open(file_).error().message, HasSubstr("no file of raw pictures"));
    EXPECT_EQ(RawFile::open(folder_ / "none").error().kind, ErrorKind::kNotFound);
}

}  // namespace
}  // namespace atrium::record
