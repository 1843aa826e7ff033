#include "site_node/record/raw_recorder.hpp"

#include "tests/unit/record/recorder_fixture.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>

namespace atrium::record {
namespace {

namespace fs = std::filesystem;
using test::bytes_of;
using testing::Each;
using testing::ElementsAre;
using testing::Field;
using testing::HasSubstr;

using Recorder = test::RecorderOnDisk;

TEST_F(Recorder, WritesARecordingThatPlaysTheSamePicturesAtTheSameTimes) {
    const fs::path folder = folder_ / "recording";
    const auto recorder = make_recorder();
    ASSERT_TRUE(recorder->start(folder));
    add(*recorder, 0, 10);
    ASSERT_TRUE(recorder->stop());
    EXPECT_THAT(recorder->counters(), Each(Field(&RecordedPictures::num_written, 10u)));

    const auto source = open(folder);
    ASSERT_NE(source, nullptr);
    EXPECT_EQ(source->num_frames(), 10u);
    EXPECT_DOUBLE_EQ(source->rig().rate_hz, 50.0);
    for (int i = 0; i < 10; ++i) {
        for (const std::size_t camera : {0U, 1U}) {
            const auto played = source->read_picture(camera, static_cast<std::size_t>(i));
            ASSERT_TRUE(played) << played.error().message;
            const capture::CameraFrame original = frame(camera, i);
            EXPECT_EQ(played->image.format, original.image.format);
            EXPECT_EQ(bytes_of(played->image), bytes_of(original.image));
        }
    }
    std::vector<capture::CameraFrame> played;
    ASSERT_TRUE(source->run({}, [&](capture::CameraFrame f) { played.push_back(std::move(f)); }));
    ASSERT_EQ(played.size(), 20u);
    for (std::size_t i = 0; i < 20; i += 2) {  // the time between the cameras is that of the room
        EXPECT_EQ((played[i + 1].capture_time - played[i].capture_time).count(), 1'000'000);
    }
    const std::string times = text_of(folder / "times.csv");
    EXPECT_THAT(times, HasSubstr("\n0,cam0,1800000000000000000\n"));
    EXPECT_THAT(times, HasSubstr("\n9,cam1,1800000000181000000\n"));
    EXPECT_EQ(text_of(folder / "settings.txt"), "key = value\n");
    EXPECT_THAT(text_of(folder / "recording.toml"), HasSubstr("state = \"complete\""));
}

// An assembler could not match them: instants are nearer to each other than the cameras' times.
TEST_F(Recorder, PlaysEachInstantAtOneTimeWithoutAPace) {
    const fs::path folder = folder_ / "recording";
    const auto recorder = make_recorder();
    ASSERT_TRUE(recorder->start(folder));
    add(*recorder, 0, 5);
    ASSERT_TRUE(recorder->stop());
    const auto source =
        capture::RecordingSource::open({.folder = folder, .as_fast_as_possible = true});
    ASSERT_TRUE(source);
    std::vector<Timestamp> times;
    ASSERT_TRUE((*source)->run(
        {}, [&](const capture::CameraFrame& f) { times.push_back(f.capture_time); }));
    ASSERT_EQ(times.size(), 10u);
    for (std::size_t i = 0; i < 10; i += 2) EXPECT_EQ(times[i], times[i + 1]);
}

TEST_F(Recorder, KeepsRecordedTimesWithoutTimesCsv) {
    const fs::path folder = folder_ / "recording";
    const auto recorder = make_recorder();
    ASSERT_TRUE(recorder->start(folder));
    add(*recorder, 0, 3);
    ASSERT_TRUE(recorder->stop());
    fs::remove(folder / "times.csv");
    std::vector<capture::CameraFrame> played;
    ASSERT_TRUE(
        open(folder)->run({}, [&](capture::CameraFrame f) { played.push_back(std::move(f)); }));
    ASSERT_EQ(played.size(), 6u);
    EXPECT_EQ((played[1].capture_time - played[0].capture_time).count(), 1'000'000);
}

TEST_F(Recorder, DropsAndCountsTheNewestPicturesWhileTheDiskStands) {
    const fs::path folder = folder_ / "recording";
    options_.queue_s = 0.1;  // five instants
    const auto recorder = make_recorder();
    ASSERT_TRUE(recorder->start(folder));
    add(*recorder, 0, 1);
    ASSERT_TRUE(test_support::comes_true([&] {
        const auto counts = recorder->counters();
        return counts[0].num_written + counts[1].num_written == 2;
    }));
    shut_disk();
    add(*recorder, 1, 21);
    const auto while_shut = recorder->counters();
    EXPECT_EQ(while_shut[0].num_dropped + while_shut[1].num_dropped, 40u - 10u);
    open_disk();
    ASSERT_TRUE(test_support::comes_true([&] {
        const auto counts = recorder->counters();
        return counts[0].num_written + counts[1].num_written == 12;
    }));
    add(*recorder, 21, 23);
    ASSERT_TRUE(recorder->stop());

    const auto counts = recorder->counters();
    EXPECT_EQ(counts[0].num_written + counts[1].num_written, 2u + 10u + 4u);
    EXPECT_EQ(counts[0].num_lost + counts[1].num_lost, 0u);
    // in the recording: the gap, and in times.csv each dropped picture
    const auto source = open(folder);
    EXPECT_EQ(source->num_frames(), 23u);
    std::vector<std::size_t> present;
    for (std::size_t i = 0; i < 23; ++i) {
        if (source->read_picture(0, i)) present.push_back(i);
    }
    EXPECT_THAT(present, ElementsAre(0, 1, 2, 3, 4, 5, 21, 22));
    const std::string times = text_of(folder / "times.csv");
    EXPECT_THAT(times, HasSubstr("\n6,cam0,1800000000120000000,dropped\n"));
    EXPECT_THAT(times, HasSubstr("\n20,cam1,1800000000401000000,dropped\n"));
    EXPECT_THAT(text_of(folder / "recording.toml"), HasSubstr("dropped = 15\n"));
}

TEST_F(Recorder, DropsWholeInstants) {
    const fs::path folder = folder_ / "recording";
    options_.queue_s = 0.1 + 0.5 / 50.0;  // five instants and a picture
    const auto recorder = make_recorder();
    ASSERT_TRUE(recorder->start(folder));
    shut_disk();
    add(*recorder, 0, 30);
    open_disk();
    ASSERT_TRUE(recorder->stop());
    const auto counts = recorder->counters();
    EXPECT_EQ(counts[0].num_written, 5u);
    EXPECT_EQ(counts[1].num_written, 5u);
    EXPECT_EQ(counts[0].num_dropped, 25u);
    EXPECT_EQ(counts[1].num_dropped, 25u);
}

TEST_F(Recorder, SaysOnOpeningThatPicturesAreMissing) {
    const fs::path folder = folder_ / "recording";
    const auto recorder = make_recorder();
    ASSERT_TRUE(recorder->start(folder));
    add(*recorder, 0, 2);
    recorder->add(frame(0, 2));
    add(*recorder, 3, 5);
    ASSERT_TRUE(recorder->stop());
    EXPECT_EQ(recorder->counters()[1].num_lost, 1u);
    std::vector<std::string> reasons;
    ASSERT_TRUE(capture::RecordingSource::open(
        {.folder = folder,
         .report_unreadable = [&](const std::string& text) { reasons.push_back(text); }}));
    ASSERT_EQ(reasons.size(), 1u);
    EXPECT_THAT(reasons[0], HasSubstr("camera 'cam1'"));
    EXPECT_THAT(reasons[0], HasSubstr("1 of 5 pictures are not in the recording"));
}

TEST_F(Recorder, PlaysACameraThatDeliveredNothing) {
    const fs::path folder = folder_ / "recording";
    const auto recorder = make_recorder();
    ASSERT_TRUE(recorder->start(folder));
    for (int i = 0; i < 4; ++i) recorder->add(frame(0, i));
    ASSERT_TRUE(recorder->stop());
    EXPECT_EQ(recorder->counters()[1].num_lost, 3u);  // the fourth may have been on its way
    const auto source = open(folder);
    ASSERT_NE(source, nullptr);
    EXPECT_TRUE(source->read_picture(0, 3));
    EXPECT_FALSE(source->read_picture(1, 3));
}

TEST_F(Recorder, BeginsWithThePreRoll) {
    const fs::path folder = folder_ / "recording";
    options_.pre_roll_s = 0.1;
    const auto recorder = make_recorder();
    add(*recorder, 0, 30);
    ASSERT_TRUE(recorder->start(folder));
    add(*recorder, 30, 33);
    ASSERT_TRUE(recorder->stop());
    EXPECT_THAT(recorder->counters(), Each(Field(&RecordedPictures::num_written, 8u)));
    EXPECT_THAT(recorder->counters(), Each(Field(&RecordedPictures::num_lost, 0u)));
    const auto source = open(folder);
    // 100 ms before the last picture, and whole instants: from 25 on
    EXPECT_EQ(source->num_frames(), 8u);
    EXPECT_EQ(bytes_of(source->read_picture(1, 0)->image), bytes_of(frame(1, 25).image));
    EXPECT_EQ(bytes_of(source->read_picture(0, 7)->image), bytes_of(frame(0, 32).image));
}

TEST_F(Recorder, CountsWhatACameraLostInThePreRoll) {
    options_.pre_roll_s = 1.0;
    const auto recorder = make_recorder();
    add(*recorder, 0, 3);
    recorder->add(frame(0, 3));
    add(*recorder, 4, 6);
    ASSERT_TRUE(recorder->start(folder_ / "recording"));
    recorder->add(frame(0, 6));
    add(*recorder, 7, 8);
    ASSERT_TRUE(recorder->stop());
    EXPECT_EQ(recorder->counters()[0].num_lost, 0u);
    EXPECT_EQ(recorder->counters()[1].num_lost, 2u);
}

TEST_F(Recorder, StartsAndStopsWhileThePicturesComeFromAnotherThread) {
    options_.pre_roll_s = 0.1;
    const auto recorder = make_recorder();
    std::jthread capture([&](const std::stop_token& stop) {
        for (int i = 0; !stop.stop_requested(); ++i) add(*recorder, i, i + 1);
    });
    for (int round = 0; round < 5; ++round) {
        const fs::path folder = folder_ / std::to_string(round);
        ASSERT_TRUE(recorder->start(folder));
        ASSERT_TRUE(
            test_support::comes_true([&] { return recorder->counters()[1].num_written >= 20; }));
        ASSERT_TRUE(recorder->stop());
        EXPECT_FALSE(recorder->is_recording());
        const auto counts = recorder->counters();
        EXPECT_THAT(counts, Each(Field(&RecordedPictures::num_lost, 0u)));
        const auto source = open(folder);
        ASSERT_NE(source, nullptr);
        for (const std::size_t camera : {0U, 1U}) {
            std::size_t num = 0;
            for (std::size_t i = 0; i < source->num_frames(); ++i)
                num += source->read_picture(camera, i) ? 1 : 0;
            EXPECT_EQ(num, counts[camera].num_written);
        }
    }
}

TEST_F(Recorder, KeepsRecordingWhenTheClockIsSetBack) {
    const fs::path folder = folder_ / "recording";
    const auto recorder = make_recorder();
    ASSERT_TRUE(recorder->start(folder));
    add(*recorder, 100, 105);
    add(*recorder, 0, 5);
    ASSERT_TRUE(recorder->stop());
    EXPECT_THAT(recorder->counters(), Each(Field(&RecordedPictures::num_written, 10u)));
    EXPECT_THAT(recorder->counters(), Each(Field(&RecordedPictures::num_lost, 0u)));
    std::size_t num_played = 0;
    ASSERT_TRUE(open(folder)->run({}, [&](const capture::CameraFrame&) { ++num_played; }));
    EXPECT_EQ(num_played, 20u);
}

TEST_F(Recorder, IgnoresPicturesWhileNothingIsRecorded) {
    const auto recorder = make_recorder();
    add(*recorder, 0, 3);
    EXPECT_TRUE(recorder->counters().empty());
    ASSERT_TRUE(recorder->start(folder_ / "recording"));
    add(*recorder, 3, 5);
    ASSERT_TRUE(recorder->stop());
    add(*recorder, 5, 8);
    EXPECT_THAT(recorder->counters(), Each(Field(&RecordedPictures::num_written, 2u)));
}

}  // namespace
}  // namespace atrium::record
