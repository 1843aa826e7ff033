#pragma once

#include "core/bus/raw_samples.hpp"
#include "core/recording/world_writer.hpp"
#include "tests/unit/viewer/test_site.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <string>

namespace atrium::viewer {

/// A folder with a recording of alice, a grey sphere: frame i of 30 a second has the luma 60 + 5 i.
class RecordedSite : public testing::Test {
protected:
    static constexpr int kNumFrames = 30;
    static constexpr std::chrono::nanoseconds kPeriod{33'333'333};
    static int luma_of(int frame) { return 60 + 5 * frame; }

    void SetUp() override {
        std::filesystem::remove_all(folder_);
        std::filesystem::create_directories(folder_);
        auto writer = recording::WorldWriter::create(
            {.file = file_, .world = "recorded", .host = "test", .version = "1"});
        ASSERT_TRUE(writer) << writer.error().message;
        write(*writer, test_site::description("alice"), 0);
        for (int i = 0; i < kNumFrames; ++i) {
            test_site::Frame frame = test_site::frame(
                "alice", static_cast<std::uint64_t>(i) + 1, static_cast<std::uint8_t>(luma_of(i)));
            frame.mesh.capture_time = begin_ + i * kPeriod;
            for (bus::CameraTexture& texture : frame.textures) {
                texture.capture_time = frame.mesh.capture_time;
                write(*writer, texture, i);
            }
            write(*writer, frame.mesh, i);
        }
        ASSERT_TRUE(writer->finish());
    }
    template <typename Message>
    void write(recording::WorldWriter& writer, const Message& message, int frame) {
        const Timestamp time = begin_ + frame * kPeriod;
        ASSERT_TRUE(writer.write({bus::find_raw_topic(bus::topic_name<Message>()),
                                  bus::RawKind::kSample,
                                  time,
                                  time,
                                  bus::to_cdr(message)}));
    }
    void TearDown() override { std::filesystem::remove_all(folder_); }

    const std::filesystem::path folder_ = std::filesystem::temp_directory_path() /
                                          ("atrium_recorded_site_" + std::to_string(getpid()));
    const std::filesystem::path file_ = folder_ / "alice.mcap";
    const Timestamp begin_{1'700'000'000'000'000'000};
};

}  // namespace atrium::viewer
