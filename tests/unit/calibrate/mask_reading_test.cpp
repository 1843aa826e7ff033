// Masks whose pixels are numbers or colours of people and of parts of the body.
#include "tools/calibrate/recording/mask_reading.hpp"

#include "tests/unit/calibrate/recording_fixture.hpp"

#include <gmock/gmock.h>

#include <fstream>

namespace atrium::calibrate {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::Contains;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

constexpr int kWidth = 64;
constexpr int kHeight = 48;
constexpr int kPartWidth = 5;
constexpr int kPartHeight = 4;

// `num` parts from 1 on, in columns of eight, away from the border; around them `empty`.
cv::Mat body(int num, int empty = 0, int type = CV_8UC1) {
    cv::Mat labels(kHeight, kWidth, type, cv::Scalar(empty));
    for (int i = 0; i < num; ++i)
        labels(
            cv::Rect(2 + kPartWidth * (i / 8), 4 + kPartHeight * (i % 8), kPartWidth, kPartHeight))
            .setTo(i + 1);
    return labels;
}
std::ptrdiff_t area_of(int num) { return std::ptrdiff_t{num} * kPartWidth * kPartHeight; }

std::string big_endian_word(std::uint32_t value) {
    return {static_cast<char>(value >> 24),
            static_cast<char>(value >> 16),
            static_cast<char>(value >> 8),
            static_cast<char>(value)};
}

std::string png_chunk(const std::string& kind_and_data) {
    std::uint32_t crc = 0xffffffffU;
    for (const char c : kind_and_data) {
        crc ^= static_cast<std::uint8_t>(c);
        for (int k = 0; k < 8; ++k) crc = (crc & 1U) != 0 ? 0xedb88320U ^ (crc >> 1U) : crc >> 1U;
    }
    return big_endian_word(static_cast<std::uint32_t>(kind_and_data.size() - 4)) + kind_and_data +
           big_endian_word(~crc);
}

// A PNG with a palette: the one of a grey picture, with another colour type.
std::string palette_png(const cv::Mat& indices, const std::string& first_colour) {
    constexpr std::size_t kSignature = 8;
    constexpr std::size_t kEndOfHeader = 33;
    std::vector<std::uint8_t> grey;
    EXPECT_TRUE(cv::imencode(".png", indices, grey));
    const std::string bytes(grey.begin(), grey.end());
    std::string header = bytes.substr(kSignature + 4, 17);
    header[13] = 3;
    std::string palette = "PLTE" + first_colour;
    for (int i = 1; i < 256; ++i)
        palette += {static_cast<char>(i * 37), static_cast<char>(i * 91), static_cast<char>(i)};
    return bytes.substr(0, kSignature) + png_chunk(header) + png_chunk(palette) +
           bytes.substr(kEndOfHeader);
}

const std::string kBlack(3, '\0');
const std::string kWhite(3, '\xff');

class ReadMasks : public testing::Test {
protected:
    fs::path write(const std::string& name, const cv::Mat& picture) const {
        EXPECT_TRUE(cv::imwrite((folder_.path() / name).string(), picture));
        return folder_.path() / name;
    }
    fs::path write_palette(const cv::Mat& indices, const std::string& first_colour) const {
        return folder_.write("palette.png", palette_png(indices, first_colour));
    }
    static std::ptrdiff_t num_people(const fs::path& file) {
        const auto mask = read_mask(file, {.labels = true});
        EXPECT_TRUE(mask);
        return mask ? std::count(mask->data.begin(), mask->data.end(), std::uint8_t{255}) : -1;
    }
    test::Folder folder_;
};

TEST_F(ReadMasks, OfLabelsByNumbersColoursAndPalettes) {
    for (const auto& first : {kBlack, kWhite, std::string("\x10\x20\x30", 3)}) {
        const fs::path file = write_palette(body(14), first);
        const MaskLabels found = find_labels({file});
        EXPECT_TRUE(found.are_labels && found.have_palette);
        EXPECT_EQ(found.num_labels, 14U);
        EXPECT_EQ(num_people(file), area_of(14));
    }
    for (const int num : {3, 8, 14, 64}) {
        for (const int type : {CV_8UC1, CV_16UC1}) {
            const fs::path file = write("grey.png", body(num, 0, type));
            const MaskLabels found = find_labels({file});
            EXPECT_TRUE(found.are_labels && !found.have_palette) << num;
            EXPECT_EQ(found.num_labels, static_cast<std::size_t>(num));
            EXPECT_EQ(num_people(file), area_of(num));
        }
    }
    // instances of Cityscapes
    EXPECT_TRUE(find_labels({write("large.png", body(14, 0, CV_16UC1) * 1000)}).are_labels);
    cv::Mat colours;
    cv::merge(std::vector<cv::Mat>{body(12) * 20, body(12), body(12) * 7}, colours);
    EXPECT_TRUE(find_labels({write("colours.png", colours)}).are_labels);
    EXPECT_EQ(num_people(folder_.path() / "colours.png"), area_of(12));
}

// Together, masks with nobody and with parts of a person are labels.
TEST_F(ReadMasks, OfLabelsAsASet) {
    const fs::path nobody = write("nobody.png", body(0));
    EXPECT_FALSE(find_labels({nobody}).are_labels);
    EXPECT_TRUE(
        find_labels({nobody, write("some.png", body(2)), write("all.png", body(9))}).are_labels);
    EXPECT_FALSE(find_labels({}).are_labels);
    EXPECT_FALSE(find_labels({folder_.path() / "missing.png"}).are_labels);
}

TEST_F(ReadMasks, OfOneOrTwoPeopleAsASiteDoes) {
    for (const int num : {1, 2}) {
        EXPECT_FALSE(find_labels({write("grey.png", body(num))}).are_labels);
        EXPECT_FALSE(find_labels({write_palette(body(num), kBlack)}).are_labels);
    }
    EXPECT_TRUE(find_labels({write_palette(body(1), kWhite)}).are_labels);
}

// What the limits protect against.
TEST_F(ReadMasks, ThatArePhotographsOrShadesHoldNoLabels) {
    EXPECT_FALSE(find_labels({write("many.png", body(65))}).are_labels);
    EXPECT_FALSE(find_labels({write("other_empty.png", body(14, 20))}).are_labels);
    EXPECT_FALSE(find_labels({write("bright.png", body(14) * 18)}).are_labels);
    EXPECT_FALSE(find_labels({write("jpeg.jpg", body(14))}).are_labels);
    // a dark, noisy picture with a black frame
    atrium::test::Random random(5);
    cv::Mat noisy(kHeight, kWidth, CV_8UC1, cv::Scalar(0));
    for (int y = 1; y < kHeight - 1; ++y)
        for (int x = 1; x < kWidth - 1; ++x)
            noisy.at<std::uint8_t>(y, x) = static_cast<std::uint8_t>(random() % 40);
    EXPECT_FALSE(find_labels({write("noisy.png", noisy)}).are_labels);
    // the soft outline of somebody who is found without certainty
    cv::Mat soft(kHeight, kWidth, CV_8UC1, cv::Scalar(0));
    for (int y = 0; y < kHeight; ++y) {
        for (int x = 0; x < kWidth; ++x)
            soft.at<std::uint8_t>(y, x) =
                static_cast<std::uint8_t>(std::max(0.0, 60.0 - 3.0 * std::hypot(x - 32, y - 24)));
    }
    EXPECT_FALSE(find_labels({write("soft.png", soft)}).are_labels);
    // transparency says who is a person
    cv::Mat cut_out;
    cv::merge(std::vector<cv::Mat>{body(9), body(9) * 9, body(9), body(9) * 20}, cut_out);
    EXPECT_FALSE(find_labels({write("cut_out.png", cut_out)}).are_labels);
}

TEST_F(ReadMasks, OfLabelsInverted) {
    const auto mask = read_mask(write("grey.png", body(14)), {.labels = true, .inverted = true});
    ASSERT_TRUE(mask);
    EXPECT_EQ(std::count(mask->data.begin(), mask->data.end(), std::uint8_t{0}), area_of(14));
}

TEST_F(ReadMasks, SurvivesDamagedPalettes) {
    const std::string good = palette_png(body(14), kWhite);
    for (std::size_t size = 0; size < good.size(); size += 11) {
        const fs::path file = folder_.write("cut.png", good.substr(0, size));
        EXPECT_FALSE(find_labels({file}).are_labels) << size;
        EXPECT_FALSE(read_mask(file, {.labels = true})) << size;
    }
    atrium::test::Random random(6);
    for (int i = 0; i < 300; ++i) {
        std::string bad = good;
        const std::size_t at = 8 + random() % 900;
        bad[at] = static_cast<char>(random() % 256);
        const fs::path file = folder_.write("bad.png", bad);
        const auto mask = read_mask(file, {.labels = true});
        if (mask) {
            EXPECT_EQ(mask->data.size(), static_cast<std::size_t>(mask->width * mask->height));
        }
        why_no_labels(file);
    }
}

class LabelledRecording : public test::ImportedRecording {
protected:
    void write_take(int width = kWidth) const {
        for (int camera = 1; camera <= 3; ++camera) {
            for (int i = 0; i < 10; ++i)
                test::write_picture(
                    take(fmt::format("images/cam{}/{:04}.png", camera, i)), width, kHeight, 40);
            test::write_picture(
                take(fmt::format("background/cam{}.png", camera)), width, kHeight, 10);
        }
    }
    static void write_bytes(const fs::path& file, const std::string& bytes) {
        fs::create_directories(file.parent_path());
        std::ofstream(file, std::ios::binary) << bytes;
    }
    template <typename BytesOf>
    void write_masks(const std::string& folder, const BytesOf& bytes_of) const {
        for (int camera = 1; camera <= 3; ++camera)
            for (int i = 0; i < 10; ++i)
                write_bytes(take(fmt::format("{}/cam{}/{:04}.png", folder, camera, i)),
                            bytes_of(i));
    }
    static std::string grey_png(const cv::Mat& picture) {
        std::vector<std::uint8_t> bytes;
        EXPECT_TRUE(cv::imencode(".png", picture, bytes));
        return {bytes.begin(), bytes.end()};
    }
    // The site's mask of picture i must show 5 + i parts.
    void expect_plain_masks() {
        const auto report = import(options_);
        ASSERT_TRUE(report) << report.error().message;
        EXPECT_THAT(report->problems, IsEmpty());
        EXPECT_THAT(report->told,
                    Contains(HasSubstr("masks: labels of people or of parts of the body")));
        for (std::size_t i = 0; i < 10; ++i) {
            const fs::path file = options_.output / fmt::format("cam2/silhouettes/{:06}.png", i);
            EXPECT_FALSE(fs::is_symlink(file));
            const cv::Mat written = cv::imread(file.string(), cv::IMREAD_UNCHANGED);
            ASSERT_EQ(written.type(), CV_8UC1);
            EXPECT_EQ(cv::countNonZero(written == 255), area_of(5 + static_cast<int>(i)));
            EXPECT_EQ(cv::countNonZero(written), cv::countNonZero(written == 255));
        }
        const auto source = capture::RecordingSource::open({.folder = options_.output});
        ASSERT_TRUE(source) << source.error().message;
        const auto frame = (*source)->read_frame(9);
        ASSERT_TRUE(frame) << frame.error().message;
        for (const auto& camera : frame->frames) {
            const auto& data = camera.silhouette->data;
            EXPECT_EQ(std::count(data.begin(), data.end(), std::uint8_t{255}), area_of(14));
        }
    }
};

TEST_F(LabelledRecording, BecomesOneOfPlainMasks) {
    write_take();
    write_masks("mask-parts", [](int i) { return grey_png(body(5 + i)); });
    expect_plain_masks();
    write_masks("mask-parts", [](int i) { return palette_png(body(5 + i), kWhite); });
    options_.output = folder_.path() / "second";
    expect_plain_masks();
    options_.output = folder_.path() / "third";
    options_.invert_masks = true;
    EXPECT_THAT(import(options_).error().message, HasSubstr("people are white already"));
}

TEST_F(LabelledRecording, KeepsMasksThatASiteReads) {
    write_take();
    for (const int person : {1, 255}) {
        write_masks("masks", [&](int) { return grey_png(body(1) * person); });
        options_.output = folder_.path() / fmt::format("made{}", person);
        const auto report = import(options_);
        ASSERT_TRUE(report) << report.error().message;
        EXPECT_THAT(report->told, Not(Contains(HasSubstr("labels"))));
        EXPECT_TRUE(fs::is_symlink(options_.output / "cam1/silhouettes/000000.png"));
    }
}

TEST_F(LabelledRecording, WithoutBackgroundInThePaletteIsAnError) {
    write_take();
    write_masks("mask-parts", [](int) { return palette_png(body(14, 200), kBlack); });
    const auto found = import(options_);
    ASSERT_FALSE(found);
    EXPECT_THAT(
        found.error().message,
        AllOf(HasSubstr("mask-parts/cam1/0000.png has a palette, but is no mask of numbers"),
              HasSubstr("the first colour of the palette, but only 0 % of the border"),
              HasSubstr("to import without masks, say --masks none")));
    options_.masks = take("mask-parts");
    const auto named = import(options_);
    ASSERT_FALSE(named);
    EXPECT_THAT(named.error().message, Not(HasSubstr("--masks none")));
    EXPECT_FALSE(fs::exists(options_.output));
}

TEST_F(LabelledRecording, IsOneWithoutMasksIfTheUserSaysSo) {
    write_take();
    write_masks("mask-parts", [](int) { return grey_png(body(65)); });
    auto report = import(options_);
    ASSERT_TRUE(report) << report.error().message;
    EXPECT_THAT(report->problems,
                Contains(AllOf(HasSubstr("shows anybody"), HasSubstr("say --masks none"))));
    options_.masks = kNoMasks;
    options_.output = folder_.path() / "second";
    report = import(options_);
    ASSERT_TRUE(report) << report.error().message;
    EXPECT_THAT(report->problems, Not(Contains(HasSubstr("masks: "))));
    EXPECT_THAT(
        report->told,
        AllOf(Contains(HasSubstr("masks: 'mask-parts/cam1' and others are not used")),
              Contains(HasSubstr("background: the empty room was found for every camera"))));
    EXPECT_FALSE(fs::exists(options_.output / "cam1/silhouettes"));
    EXPECT_TRUE(fs::exists(options_.output / "cam1/background.png"));
    options_.invert_masks = true;
    EXPECT_THAT(import(options_).error().message,
                AllOf(HasSubstr("no masks were found"), Not(HasSubstr("none"))));
}

// Masks of some cameras, of another size or as videos stop the import, too.
TEST_F(LabelledRecording, NamesTheWayOnWithoutMasksThatItFound) {
    write_take();
    const auto message = [&] {
        const auto report = import(options_);
        return report ? fmt::format("{}", fmt::join(report->problems, "\n"))
                      : report.error().message;
    };
    test::write_picture(take("mask-parts/cam1/0000.png"), kWidth, kHeight, 255);
    EXPECT_THAT(message(), AllOf(HasSubstr("has none of"), HasSubstr("say --masks none")));
    options_.force = true;
    for (const char* camera : {"cam1", "cam2", "cam3"})
        test::write_picture(take("mask-parts") / camera / "0000.png", 32, 24, 255);
    EXPECT_THAT(message(), AllOf(HasSubstr("another size"), HasSubstr("say --masks none")));
    write_masks("mask-parts",
                [](int) { return grey_png(cv::Mat(kHeight, kWidth, CV_8UC1, cv::Scalar(255))); });
    EXPECT_THAT(message(), AllOf(HasSubstr("look inverted"), HasSubstr("say --masks none")));
    fs::remove_all(take("mask-parts"));
    for (const char* camera : {"cam1.avi", "cam2.avi", "cam3.avi"})
        test::write_video(take("mask-parts") / camera, kWidth, kHeight, 10);
    EXPECT_THAT(message(), AllOf(HasSubstr("is a video"), HasSubstr("say --masks none")));
}

}  // namespace
}  // namespace atrium::calibrate
