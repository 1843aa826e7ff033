#pragma once

#include "core/bus/messages.hpp"
#include "core/recording/cursor.hpp"
#include "core/recording/world_file.hpp"
#include "core/recording/world_writer.hpp"
#include "tests/support/random.hpp"

#include <gtest/gtest.h>

#include <string>
#include <tuple>
#include <vector>

/// Recordings for the tests of core/recording.
namespace atrium::recording::testing {

inline constexpr Timestamp kBegin{1'700'000'000'000'000'000};
inline Timestamp at(double seconds) { return kBegin + from_milliseconds(seconds * 1e3); }

template <typename T>
T value(Expected<T> expected) {
    if (!expected) throw std::runtime_error(expected.error().message);
    return std::move(*expected);
}

template <typename Message>
Recorded recorded(const Message& message,
                  Timestamp time,
                  bus::RawKind kind = bus::RawKind::kSample) {
    const bus::RawTopic* topic = bus::find_raw_topic(bus::topic_name<Message>());
    auto cdr = bus::to_cdr(message);
    if (kind != bus::RawKind::kSample) cdr = value(topic->key_cdr({kind, time, cdr}));
    return {topic, kind, time, time + std::chrono::milliseconds(-1), std::move(cdr)};
}

inline bus::SiteDescription description(const std::string& site) {
    bus::SiteDescription message;
    message.site = site;
    geometry::CalibratedCamera camera;
    camera.name = "c0";
    camera.intrinsics.width = 640;
    camera.intrinsics.height = 480;
    camera.intrinsics.fx = camera.intrinsics.fy = 500.0;
    message.cameras.assign(2, camera);
    message.cameras[1].name = "c1";
    message.bounds_site = {{-1.0, -1.0, 0.0}, {1.0, 1.0, 2.0}};
    return message;
}

inline bus::SitePlacement placement(const std::string& site, double x_m) {
    bus::SitePlacement message;
    message.site = site;
    message.world_from_site.translation.x() = x_m;
    return message;
}

/// With textures of both cameras.
inline bus::SiteMesh mesh(const std::string& site, std::uint64_t frame_id) {
    bus::SiteMesh message;
    message.site = site;
    message.frame_id = frame_id;
    message.capture_time = {static_cast<std::int64_t>(frame_id) * 1'000'000};
    message.textured_cameras = {0, 1};
    message.draco.assign(50 + frame_id % 7, static_cast<std::uint8_t>(frame_id));
    return message;
}

inline bus::CameraTexture texture(const std::string& site,
                                  std::uint32_t camera,
                                  std::uint64_t frame_id) {
    bus::CameraTexture message;
    message.site = site;
    message.camera = camera;
    message.frame_id = frame_id;
    message.capture_time = {static_cast<std::int64_t>(frame_id) * 1'000'000};
    message.crop_px = {0, 0, 16, 16};
    message.colour.assign(30, static_cast<std::uint8_t>(frame_id));
    message.mask.assign(5, static_cast<std::uint8_t>(camera));
    return message;
}

inline bus::SceneState state(std::uint64_t tick) {
    bus::SceneState message;
    message.world = "w";
    message.tick = tick;
    message.time = {static_cast<std::int64_t>(tick) * 16'000'000};
    message.objects.resize(2);
    message.objects[1].object = 1;
    return message;
}

inline bus::SceneCommand command(const std::string& sender) {
    bus::SceneCommand message;
    message.sender = sender;
    return message;
}

inline bus::SceneObject object(std::uint32_t id, double mass_kg) {
    bus::SceneObject message;
    message.object = id;
    message.name = "thing";
    message.mass_kg = mass_kg;
    return message;
}

inline bus::Presence presence(bus::ProgramKind kind, const std::string& name) {
    bus::Presence message;
    message.kind = kind;
    message.name = name;
    message.instance = 7;
    message.host = "host";
    message.version = "1";
    return message;
}

/// What of a sample a recording must keep.
using Kept =
    std::tuple<std::string, bus::RawKind, std::int64_t, std::int64_t, std::vector<std::byte>>;

inline Kept kept(const Recorded& sample) {
    return {std::string(sample.topic->name()),
            sample.kind,
            sample.time.ns,
            sample.written.ns,
            sample.cdr};
}
inline Kept kept(const PlayedSample& sample) {
    return {std::string(sample.topic->name()),
            sample.raw.kind,
            sample.time.ns,
            sample.raw.written.ns,
            {sample.raw.cdr.begin(), sample.raw.cdr.end()}};
}
/// Without bytes: short in messages of failures.
inline void PrintTo(const Kept& sample, std::ostream* out) {
    *out << std::get<0>(sample) << " kind " << static_cast<int>(std::get<1>(sample)) << " at "
         << static_cast<double>(std::get<2>(sample) - kBegin.ns) * 1e-9 << " s, "
         << std::get<4>(sample).size() << " bytes";
}

/// All samples of a recording as a cursor gives them.
inline std::vector<Kept> all_samples(const std::shared_ptr<const WorldFile>& world) {
    std::vector<Kept> samples;
    Cursor cursor(world);
    for (const PlayedSample* next = cursor.peek(); next != nullptr; next = cursor.peek()) {
        samples.push_back(kept(*next));
        cursor.pop();
    }
    EXPECT_EQ(cursor.num_damaged(), 0u) << cursor.damage();
    return samples;
}

inline WriterOptions writer_options(const std::filesystem::path& file) {
    WriterOptions options;
    options.file = file;
    options.world = "studio";
    options.host = "host";
    options.version = "0.1";
    return options;
}

/// Writes the samples; flushes lanes now and then, as a recorder does by its clock.
inline std::vector<std::filesystem::path> write_recording(WriterOptions options,
                                                          const std::vector<Recorded>& samples,
                                                          int flush_every = 25) {
    auto writer = WorldWriter::create(std::move(options));
    if (!writer) throw std::runtime_error(writer.error().message);
    int count = 0;
    for (const Recorded& sample : samples) {
        EXPECT_TRUE(writer->write(sample));
        if (++count % flush_every == 0) {
            EXPECT_TRUE(
                writer->flush_due(std::chrono::steady_clock::now() + std::chrono::hours(1)));
        }
    }
    EXPECT_TRUE(writer->finish());
    return writer->files();
}

/// Any samples of a world with two sites, things and a server, by time: instances come and go,
/// textures are lost now and then.
inline std::vector<Recorded> random_world(std::uint64_t seed, int num_steps) {
    test::Random random(seed);
    std::vector<Recorded> samples;
    Timestamp now = kBegin;
    const auto add = [&](const auto& message, bus::RawKind kind = bus::RawKind::kSample) {
        now = now + std::chrono::microseconds(test::between(random, 0, 3000));
        samples.push_back(recorded(message, now, kind));
    };
    const auto ending = [&] {
        return test::between(random, 0, 1) == 0 ? bus::RawKind::kDisposed : bus::RawKind::kLost;
    };
    for (int step = 0; step < num_steps; ++step) {
        const std::string site = test::between(random, 0, 1) == 0 ? "alice" : "bob";
        const auto frame = static_cast<std::uint64_t>(step);
        switch (test::between(random, 0, 30)) {
            case 0:
                add(description(site));
                break;
            case 1:
                add(description(site), ending());
                break;
            case 2:
                add(placement(site, step));
                break;
            case 3:
                add(placement(site, step), ending());
                break;
            case 4:
                add(object(static_cast<std::uint32_t>(test::between(random, 0, 3)), step + 1.0));
                break;
            case 5:
                add(object(static_cast<std::uint32_t>(test::between(random, 0, 3)), 1.0), ending());
                break;
            case 6:
                add(mesh(site, frame), ending());
                break;
            case 7:
                add(state(frame), ending());
                break;
            case 8:
                add(command(site));
                break;
            case 9:
                add(presence(bus::ProgramKind::kSiteNode, site));
                break;
            case 10:
                now = now + std::chrono::milliseconds(test::between(random, 0, 1500));
                break;
            case 11: {
                bus::SiteStatus status;
                status.site = site;
                add(status);
                break;
            }
            case 12: {
                bus::SiteStatus status;
                status.site = site;
                add(status, ending());
                break;
            }
            default:
                if (step % 3 == 0) {
                    add(state(frame));
                    break;
                }
                for (const std::uint32_t camera : {0U, 1U}) {
                    if (test::between(random, 0, 5) != 0) add(texture(site, camera, frame));
                }
                add(mesh(site, frame));
        }
    }
    return samples;
}

}  // namespace atrium::recording::testing
