#pragma once

#include "core/bus/messages.hpp"
#include "core/codec/mesh_codec.hpp"
#include "core/recording/world_writer.hpp"
#include "tests/support/world/physics_meshes.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>

namespace atrium::physics_test {

/// Long ago: a recording's times are those of its making.
constexpr Timestamp kRecordingBegin{1'700'000'000'000'000'000};

/// Writes a recording of people who each are one foot: a box of 0.1 x 0.2 x 0.3 m. Times are since
/// the beginning [s].
class FootRecording {
public:
    /// Replaces the file.
    explicit FootRecording(std::filesystem::path file) : file_(std::move(file)) {
        std::filesystem::remove(file_);
        recording::WriterOptions options;
        options.file = file_;
        options.world = "rec";
        options.host = "here";
        options.version = "1";
        auto writer = recording::WorldWriter::create(std::move(options));
        EXPECT_TRUE(writer) << writer.error().message;
        if (writer) writer_.emplace(std::move(*writer));
    }
    const std::filesystem::path& file() const { return file_; }

    template <typename Message>
    void write(double time_s, const Message& message, bus::RawKind kind = bus::RawKind::kSample) {
        const bus::RawTopic* const topic = bus::find_raw_topic(bus::topic_name<Message>());
        const Timestamp time = time_at(time_s);
        auto cdr = bus::to_cdr(message);
        if (kind != bus::RawKind::kSample) cdr = topic->key_cdr({kind, time, cdr}).value();
        ASSERT_TRUE(writer_ && writer_->write({topic, kind, time, time, std::move(cdr)}));
    }
    void describe(double time_s, const std::string& site) {
        bus::SiteDescription description;
        description.site = site;
        description.bounds_site.add({-2, -2, 0});
        description.bounds_site.add({2, 2, 2});
        write(time_s, description);
    }
    /// `place`: of the foot's centre, in the site's frame.
    void put_foot(double time_s, const std::string& site, const Eigen::Vector3d& place) {
        bus::SiteMesh mesh;
        mesh.site = site;
        mesh.capture_time = time_at(time_s) + -std::chrono::milliseconds(20);
        mesh.frame_id = ++frame_;
        ASSERT_TRUE(codec::MeshEncoder().encode(
            make_box_mesh({0.1, 0.2, 0.3}, {Eigen::Quaterniond::Identity(), place}, 3),
            {},
            mesh.draco));
        write(time_s, mesh);
    }
    void finish() { ASSERT_TRUE(writer_ && writer_->finish()); }

private:
    static Timestamp time_at(double time_s) {
        return kRecordingBegin + std::chrono::nanoseconds(static_cast<std::int64_t>(time_s * 1e9));
    }

    std::filesystem::path file_;
    std::optional<recording::WorldWriter> writer_;
    std::uint64_t frame_ = 0;
};

}  // namespace atrium::physics_test
