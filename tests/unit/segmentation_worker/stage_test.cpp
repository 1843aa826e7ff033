#include "site_node/silhouette_stage/silhouette_stage.hpp"
#include "tests/support/temporary_folder.hpp"
#include "tests/unit/segmentation/test_room.hpp"
#include "tests/unit/segmentation_worker/fake_worker.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <vector>

namespace atrium::site_node {
namespace {

using atrium::test::FakeConnection;
using atrium::test::FakeWorker;
using segmentation::test::kPatch;
using segmentation::test::kWhole;

constexpr double kLong_ms = 60'000.0;

geometry::CalibratedCamera camera() {
    geometry::CalibratedCamera made;
    made.name = "north";
    made.intrinsics = {.width = kWhole.width,
                       .height = kWhole.height,
                       .fx = 200,
                       .fy = 200,
                       .cx = kWhole.width / 2.0,
                       .cy = kWhole.height / 2.0};
    return made;
}

// A room in light that changes from picture to picture, and a person at kPatch.
capture::CameraFrame frame(int index, std::mt19937& random) {
    auto picture =
        std::make_shared<image::YuvImage>(segmentation::test::room(kWhole.width, kWhole.height));
    segmentation::test::scale_light(*picture, kWhole, 1.0 + 0.002 * (index % 40));
    for (int y = kPatch.y; y < kPatch.y + kPatch.height; ++y)
        std::fill_n(picture->y.row(y) + kPatch.x, kPatch.width, std::uint8_t{20});
    segmentation::test::add_noise(*picture, 1.0, 0.5, random);
    return {0, {index}, image::RawImage(std::move(picture)), nullptr};
}

SilhouetteStage make_stage() {
    std::mt19937 random(1);
    const image::YuvImage room = segmentation::test::room(kWhole.width, kWhole.height);
    return SilhouetteStage(
        camera(), {}, segmentation::Segmenter(segmentation::test::learn(room, 8, random), {}));
}

std::unique_ptr<segmentation_worker::WorkerClient> make_client(
    const std::filesystem::path& socket,
    const std::shared_ptr<segmentation_worker::WorkerTally>& tally,
    const segmentation::SegmentationAreas& areas = {}) {
    return segmentation_worker::WorkerClient::create(
               {socket, kLong_ms, std::chrono::milliseconds(0)},
               {"north", kWhole.width, kWhole.height, areas},
               {},
               tally)
        .value();
}

class StageWithWorker : public testing::Test {
protected:
    atrium::test::TemporaryFolder folder_;
    std::filesystem::path path_ = folder_ / "worker";
    std::shared_ptr<segmentation_worker::WorkerTally> tally_ =
        std::make_shared<segmentation_worker::WorkerTally>(kLong_ms);
};

// The built-in segmentation goes on with every picture, whether or not its mask is used: where the
// worker gives none, the mask is the one of a site without a worker, light included.
TEST_F(StageWithWorker, FallsBackToTheMaskThatASiteWithoutAWorkerHas) {
    SilhouetteStage alone = make_stage();
    SilhouetteStage with = make_stage();
    const FakeWorker worker(path_);
    with.ask(make_client(path_, tally_));
    PictureSilhouette found_alone;
    PictureSilhouette found;
    std::mt19937 random(2);
    std::unique_ptr<FakeConnection> connection;
    int num_answered = 0;
    for (int i = 0; i < 200; ++i) {
        const capture::CameraFrame picture = frame(i, random);
        ASSERT_TRUE(alone.find(picture, {}, found_alone));
        ASSERT_TRUE(with.begin(picture, {}, found));
        if (i == 20) {
            connection = worker.accept();
            connection->ready();
        }
        bool is_answered = false;
        if (i > 20) {
            const std::uint64_t number = connection->receive()->number;
            is_answered = number % 3 != 0;
            if (is_answered)
                connection->answer(number, 255);
            else
                connection->send(connection->message(3, number));
        }
        ASSERT_TRUE(with.find(picture, {}, found));
        if (is_answered) {
            ++num_answered;
            EXPECT_EQ(segmentation::test::foreground_part(found.mask.mask, kWhole), 1.0);
        } else {
            ASSERT_EQ(found.mask.mask.data, found_alone.mask.mask.data) << i;
            ASSERT_EQ(found.contours, found_alone.contours) << i;
        }
    }
    EXPECT_GT(segmentation::test::foreground_part(found_alone.mask.mask, kPatch), 0.95);
    EXPECT_EQ(tally_->counts(),
              (segmentation_worker::WorkerCounts{.num_answered = std::uint64_t(num_answered),
                                                 .num_invalid = 179u - unsigned(num_answered),
                                                 .num_absent = 21}));
}

TEST_F(StageWithWorker, TakesContoursFromTheAlphaInsideTheAreas) {
    SilhouetteStage stage = make_stage();
    const FakeWorker worker(path_);
    stage.ask(make_client(
        path_, tally_, {.include = {{{0, 0}, {99.5, 0}, {99.5, 160}, {0, 160}}}, .exclude = {}}));
    std::mt19937 random(3);
    PictureSilhouette found;
    ASSERT_TRUE(stage.find(frame(0, random), {}, found));
    const auto connection = worker.accept();
    connection->ready();
    const capture::CameraFrame picture = frame(1, random);
    ASSERT_TRUE(stage.begin(picture, {}, found));
    const std::uint64_t number = connection->receive()->number;
    std::ranges::fill(connection->plane(56, 1), std::uint8_t{0});
    for (int y = 30; y < 90; ++y)  // half of it lies outside
        std::fill_n(connection->plane(56, 1).data() + y * kWhole.width + 80, 40, std::uint8_t{255});
    connection->send(connection->message(2, number));
    ASSERT_TRUE(stage.find(picture, {}, found));
    ASSERT_EQ(found.contours.size(), 1u);
    EXPECT_EQ(found.subject, (image::PixelRect{80, 30, 20, 60}));
}

// Pictures that need conversion are converted as a whole: the worker may see people anywhere.
TEST_F(StageWithWorker, ConvertsWholePicturesForTheWorker) {
    SilhouetteStage stage = make_stage();
    const FakeWorker worker(path_);
    stage.ask(make_client(path_, tally_));
    std::vector<std::uint8_t> bytes(3 * kWhole.width * static_cast<std::size_t>(kWhole.height));
    for (std::size_t i = 0; i < bytes.size(); ++i) bytes[i] = static_cast<std::uint8_t>(i % 251);
    image::RawImage raw;
    raw.format = image::PixelFormat::kBgr;
    raw.width = kWhole.width;
    raw.height = kWhole.height;
    raw.planes[0] = {bytes.data(), 3 * static_cast<std::size_t>(kWhole.width)};
    PictureSilhouette found;
    ASSERT_TRUE(stage.find({0, {1}, raw, nullptr}, {}, found));
    const auto connection = worker.accept();
    connection->ready();
    found.picture_buffer = {};
    ASSERT_TRUE(stage.begin({0, {2}, raw, nullptr}, {}, found));
    EXPECT_THAT(connection->plane(40, 3), testing::ElementsAreArray(bytes));
    connection->answer(connection->receive()->number, 255);
    ASSERT_TRUE(stage.find({0, {2}, raw, nullptr}, {}, found));
    EXPECT_EQ(segmentation::test::foreground_part(found.mask.mask, kWhole), 1.0);
    image::YuvImage whole;
    const image::YuvView expected = image::working_view(raw, whole);
    for (int y = 0; y < kWhole.height; ++y) {
        ASSERT_TRUE(std::equal(
            expected.y.row(y), expected.y.row(y) + kWhole.width, found.picture.y.row(y)));
    }
}

TEST_F(StageWithWorker, LeavesFramesWithSilhouettesAlone) {
    SilhouetteStage stage = make_stage();
    const FakeWorker worker(path_);
    stage.ask(make_client(path_, tally_));
    std::mt19937 random(4);
    capture::CameraFrame picture = frame(0, random);
    picture.silhouette = std::make_shared<image::Mask>(kWhole.width, kWhole.height, 255);
    PictureSilhouette found;
    ASSERT_TRUE(stage.begin(picture, {}, found));
    stage.await();
    ASSERT_TRUE(stage.find(picture, {}, found));
    EXPECT_EQ(segmentation::test::foreground_part(found.mask.mask, kWhole), 1.0);
    EXPECT_EQ(tally_->counts().num_pictures(), 0u);
}

TEST_F(StageWithWorker, RefusesPicturesOfAnotherSizeAsWithout) {
    SilhouetteStage stage = make_stage();
    stage.ask(make_client(path_, tally_));
    const auto small =
        std::make_shared<image::YuvImage>(segmentation::test::room(kWhole.width / 2, 80));
    PictureSilhouette found;
    const auto done = stage.find({0, {1}, image::RawImage(small), nullptr}, {}, found);
    ASSERT_FALSE(done);
    EXPECT_EQ(done.error().kind, ErrorKind::kInvalidData);
}

}  // namespace
}  // namespace atrium::site_node
