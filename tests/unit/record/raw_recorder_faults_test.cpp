#include "tests/unit/record/recorder_fixture.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>

#include <algorithm>

// What goes wrong with disks and folders.
namespace atrium::record {
namespace {

namespace fs = std::filesystem;
using test::bytes_of;
using testing::HasSubstr;

using FaultyRecorder = test::RecorderOnDisk;

TEST_F(FaultyRecorder, RefusesAFolderThatHoldsARecording) {
    const fs::path folder = folder_ / "recording";
    const auto recorder = make_recorder();
    ASSERT_TRUE(recorder->start(folder));
    ASSERT_TRUE(recorder->stop());
    const auto again = recorder->start(folder);
    ASSERT_FALSE(again);
    EXPECT_EQ(again.error().kind, ErrorKind::kConfiguration);
    EXPECT_THAT(again.error().message, HasSubstr(folder.string()));
    EXPECT_THAT(again.error().message, HasSubstr("holds a recording already"));
    EXPECT_TRUE(recorder->result());
}

TEST_F(FaultyRecorder, RefusesOtherFolders) {
    const auto recorder = make_recorder();
    EXPECT_THAT(recorder->start(folder_ / "file" / "inner"), testing::IsTrue());
    ASSERT_TRUE(recorder->stop());
    std::ofstream(folder_ / "text") << "x";
    EXPECT_THAT(recorder->start(folder_ / "text").error().message, HasSubstr("is no folder"));
    EXPECT_THAT(recorder->start(folder_).error().message, HasSubstr("is not empty"));
    EXPECT_EQ(recorder->start(folder_ / "text" / "inner").error().kind, ErrorKind::kUnavailable);
    EXPECT_FALSE(recorder->is_recording());
}

TEST_F(FaultyRecorder, RecordsOnlyOnceAtATime) {
    const auto recorder = make_recorder();
    ASSERT_TRUE(recorder->start(folder_ / "a"));
    EXPECT_THAT(recorder->start(folder_ / "b").error().message, HasSubstr("already recording"));
    EXPECT_FALSE(fs::exists(folder_ / "b"));
    EXPECT_TRUE(recorder->is_recording());
}

TEST_F(FaultyRecorder, NamesTheMemoryThatAPreRollNeeds) {
    options_.bytes_per_instant = 2'000'000;
    options_.pre_roll_s = 30.0;
    options_.memory_bytes = 1'000'000'000;
    const auto recorder =
        RawRecorder::create({"lab", test::make_rig(2, 1000, 1000, 50.0), {}, ""}, options_, calls_);
    ASSERT_FALSE(recorder);
    EXPECT_EQ(recorder.error().kind, ErrorKind::kConfiguration);
    EXPECT_THAT(recorder.error().message, HasSubstr("2 cameras deliver 100 MB/s"));
    EXPECT_THAT(recorder.error().message, HasSubstr("need 3100 MB, allowed are 1000 MB"));
    EXPECT_THAT(recorder.error().message, HasSubstr("lower record.pre_roll_s to 9.0"));
}

TEST_F(FaultyRecorder, DoesNotBeginOnADiskThatIsNearlyFull) {
    set_free_bytes(options_.min_free_bytes);
    const auto recorder = make_recorder();
    const auto started = recorder->start(folder_ / "recording");
    ASSERT_FALSE(started);
    EXPECT_EQ(started.error().kind, ErrorKind::kUnavailable);
    EXPECT_THAT(started.error().message, HasSubstr("the disk is nearly full"));
    EXPECT_FALSE(fs::exists(folder_ / "recording"));
}

TEST_F(FaultyRecorder, EndsInOrderBeforeTheDiskIsFull) {
    const fs::path folder = folder_ / "recording";
    const auto recorder = make_recorder();
    ASSERT_TRUE(recorder->start(folder));
    add(*recorder, 0, 5);
    set_free_bytes(options_.min_free_bytes - 1);
    ASSERT_TRUE(test_support::comes_true([&] { return !recorder->is_recording(); }));
    ASSERT_TRUE(test_support::comes_true([&] { return !recorder->result(); }));
    EXPECT_EQ(recorder->result().error().kind, ErrorKind::kInternal);
    EXPECT_THAT(recorder->result().error().message, HasSubstr("the disk is nearly full"));
    add(*recorder, 5, 8);  // the site goes on
    EXPECT_EQ(open(folder)->num_frames(), 5u);
    EXPECT_THAT(text_of(folder / "recording.toml"), HasSubstr("state = \"ended\""));
    EXPECT_THAT(text_of(folder / "recording.toml"), HasSubstr("reason = \"" + folder.string()));
}

// A limit of the process stands for a full disk: the system itself refuses to write.
TEST_F(FaultyRecorder, KeepsWholePicturesWhenTheSystemWritesNoMore) {
    const fs::path folder = folder_ / "recording";
    options_.codec = capture::RawCodec::kRaw;
    const auto recorder = make_recorder();
    ASSERT_TRUE(recorder->start(folder));
    rlimit former{};
    ASSERT_EQ(getrlimit(RLIMIT_FSIZE, &former), 0);
    rlimit limited = former;
    limited.rlim_cur = 20'000;
    ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &limited), 0);
    add(*recorder, 0, 40);
    const bool has_ended = test_support::comes_true([&] { return !recorder->result(); });
    ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &former), 0);
    ASSERT_TRUE(has_ended);
    EXPECT_THAT(recorder->result().error().message, HasSubstr("frames.raw: cannot write"));
    const auto counts = recorder->counters();
    for (const std::size_t camera : {0U, 1U}) {
        EXPECT_EQ(counts[camera].num_written + counts[camera].num_dropped, 40u);
        EXPECT_GT(counts[camera].num_dropped, 0u);
    }
    const auto source = open(folder);
    ASSERT_NE(source, nullptr);
    for (const std::size_t camera : {0U, 1U}) {
        for (std::size_t i = 0; i < counts[camera].num_written; ++i) {
            const auto picture = source->read_picture(camera, i);
            ASSERT_TRUE(picture) << picture.error().message;
            EXPECT_EQ(bytes_of(picture->image), bytes_of(frame(camera, static_cast<int>(i)).image));
        }
    }
}

// The files as a killed process leaves them: whatever was written until then.
TEST_F(FaultyRecorder, LeavesAPlayableRecordingWhenItIsKilled) {
    const fs::path folder = folder_ / "recording";
    const auto recorder = make_recorder();
    ASSERT_TRUE(recorder->start(folder));
    add(*recorder, 0, 6);
    ASSERT_TRUE(test_support::comes_true([&] {
        const auto counts = recorder->counters();
        return counts[0].num_written == 6 && counts[1].num_written == 6;
    }));
    const fs::path copy = folder_ / "copy";
    fs::copy(folder, copy, fs::copy_options::recursive);
    const auto source = open(copy);
    ASSERT_NE(source, nullptr);
    EXPECT_EQ(source->num_frames(), 6u);
    EXPECT_THAT(text_of(copy / "recording.toml"), HasSubstr("state = \"running\""));
}

TEST_F(FaultyRecorder, PlaysWithACutOffLineOfTimes) {
    const fs::path folder = folder_ / "recording";
    const auto recorder = make_recorder();
    ASSERT_TRUE(recorder->start(folder));
    add(*recorder, 0, 3);
    ASSERT_TRUE(recorder->stop());
    const auto size = fs::file_size(folder / "times.csv");
    for (std::uintmax_t cut = 1; cut < 30; ++cut) {
        fs::resize_file(folder / "times.csv", size - cut);
        EXPECT_NE(open(folder), nullptr) << cut;
    }
}

TEST_F(FaultyRecorder, LeavesOutPicturesOfAnotherSize) {
    const auto recorder = make_recorder();
    ASSERT_TRUE(recorder->start(folder_ / "recording"));
    add(*recorder, 0, 2);
    capture::CameraFrame other = frame(0, 2);
    other.image = test::make_picture(image::PixelFormat::kBayerGB, 20, 20, 1);
    recorder->add(other);
    add(*recorder, 3, 4);
    ASSERT_TRUE(recorder->stop());
    EXPECT_EQ(recorder->counters()[0].num_written, 3u);
    EXPECT_EQ(recorder->counters()[0].num_dropped, 1u);
}

}  // namespace
}  // namespace atrium::record
