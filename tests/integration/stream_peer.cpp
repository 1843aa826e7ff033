#include "core/bus/bus.hpp"
#include "core/bus/participant.hpp"

#include <dds/ddsc/dds_statistics.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <string>
#include <thread>
#include <vector>

// One end of a stream of frames like a site's: a mesh and eight textures each, at 30 Hz.
//
//   stream_peer write NETWORK PROFILES FRAMES MESH_BYTES TEXTURE_BYTES TEXTURE_WRITERS
//   stream_peer read NETWORK PROFILES
//
// Both print "matched" once they have found each other, and their measurements at the end: the
// writer after its frames, the reader on SIGTERM.
namespace {

using namespace atrium;
using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;

constexpr std::uint32_t kNumCameras = 8;
constexpr auto kPeriod = std::chrono::nanoseconds(1s) / 30;
volatile std::sig_atomic_t stopped = 0;

template <typename T>
T value(Expected<T> expected) {
    if (expected) return std::move(*expected);
    fmt::print(stderr, "{}\n", expected.error().message);
    std::exit(1);
}

void say(const std::string& text) {
    fmt::print("{}\n", text);
    std::fflush(stdout);
}

// Bytes retransmitted by all writers so far.
std::uint64_t retransmitted_bytes(const bus::Participant& participant) {
    std::array<dds_entity_t, 16> writers{};
    const int n =
        dds_get_children(participant.impl()->publisher.get(), writers.data(), writers.size());
    std::uint64_t sum = 0;
    for (int i = 0; i < n; ++i) {
        dds_statistics* statistics = dds_create_statistics(writers[static_cast<std::size_t>(i)]);
        if (statistics == nullptr) continue;
        const auto* entry = dds_lookup_statistic(statistics, "rexmit_bytes");
        if (entry != nullptr) sum += entry->u.u64;
        dds_delete_statistics(statistics);
    }
    return sum;
}

struct FrameWriter {
    FrameWriter(const bus::Participant& participant, std::uint32_t num_texture_writers)
        : meshes(value(bus::Writer<bus::SiteMesh>::create(participant))) {
        for (std::uint32_t i = 0; i < num_texture_writers; ++i)
            textures.push_back(value(bus::Writer<bus::CameraTexture>::create(participant)));
    }

    bool has_readers() const {
        return meshes.num_readers() > 0 && std::ranges::all_of(textures, [](const auto& writer) {
                   return writer.num_readers() > 0;
               });
    }

    void write(std::uint64_t frame, std::size_t mesh_bytes, std::size_t texture_bytes) {
        texture.site = mesh.site = "sender";
        texture.frame_id = mesh.frame_id = frame;
        texture.capture_time = mesh.capture_time = Timestamp::now();
        texture.crop_px = {0, 0, 64, 64};
        texture.colour.assign(texture_bytes, 1);
        mesh.draco.assign(mesh_bytes, 1);
        for (texture.camera = 0; texture.camera < kNumCameras; ++texture.camera)
            num_failed += textures[texture.camera % textures.size()].write(texture) ? 0 : 1;
        num_failed += meshes.write(mesh) ? 0 : 1;
    }

    bus::Writer<bus::SiteMesh> meshes;
    std::vector<bus::Writer<bus::CameraTexture>> textures;  // cameras in turn
    bus::SiteMesh mesh;
    bus::CameraTexture texture;
    int num_failed = 0;
};

struct Sizes {
    std::uint64_t num_frames;
    std::size_t mesh_bytes;
    std::size_t texture_bytes;
    std::uint32_t num_texture_writers;
};

void write_frames(const bus::Participant& participant, const Sizes& sizes) {
    FrameWriter writer(participant, sizes.num_texture_writers);
    while (!writer.has_readers()) std::this_thread::sleep_for(5ms);
    // the reader is matched when the writer is, plus a link delay
    std::this_thread::sleep_for(200ms);
    say("matched");
    const auto start = Clock::now();
    const std::uint64_t retransmitted_before = retransmitted_bytes(participant);
    std::vector<double> durations_ms;
    for (std::uint64_t frame = 1; frame <= sizes.num_frames; ++frame) {
        std::this_thread::sleep_until(start + frame * kPeriod);
        const auto before = Clock::now();
        writer.write(frame, sizes.mesh_bytes, sizes.texture_bytes);
        durations_ms.push_back(
            std::chrono::duration<double, std::milli>(Clock::now() - before).count());
    }
    std::this_thread::sleep_for(1s);  // for repairs of losses at the end
    fmt::print("failed {}\nretransmitted {}\n",
               writer.num_failed,
               retransmitted_bytes(participant) - retransmitted_before);
    for (const double duration_ms : durations_ms) fmt::print("write {}\n", duration_ms);
    say("end");
}

struct Arrival {
    std::uint32_t key;  // kNumCameras: the mesh
    std::uint64_t frame;
    std::int64_t capture_ns;
    std::int64_t arrived_ns;
};

void read_frames(const bus::Participant& participant) {
    auto meshes = value(bus::Reader<bus::SiteMesh>::create(participant));
    auto textures = value(bus::Reader<bus::CameraTexture>::create(participant));
    auto waiter = value(bus::Waiter::create(participant));
    waiter.add(meshes);
    waiter.add(textures);
    std::vector<Arrival> arrivals;
    bool matched = false;
    while (stopped == 0) {
        waiter.wait(50ms);
        textures.take([&](bus::CameraTexture&& t) {
            arrivals.push_back({t.camera, t.frame_id, t.capture_time.ns, Timestamp::now().ns});
        });
        meshes.take([&](bus::SiteMesh&& m) {
            arrivals.push_back({kNumCameras, m.frame_id, m.capture_time.ns, Timestamp::now().ns});
        });
        if (!matched && meshes.num_writers() > 0 && textures.num_writers() > 0) {
            matched = true;
            say("matched");
        }
    }
    for (const Arrival& a : arrivals)
        fmt::print("sample {} {} {} {}\n", a.key, a.frame, a.capture_ns, a.arrived_ns);
    say("end");
}

}  // namespace

int main(int argc, char** argv) {
    const std::vector<std::string> words(argv + 1, argv + argc);
    if (words.size() != 3 && words.size() != 7) return 2;
    std::signal(SIGTERM, [](int) { stopped = 1; });
    bus::BusOptions options;
    options.world = "stream-peer";
    options.network = words[1];
    options.profiles_file = words[2];
    const auto participant = value(bus::Participant::create(options));
    if (words[0] == "read") {
        read_frames(participant);
    } else {
        write_frames(participant,
                     {std::stoull(words[3]),
                      std::stoull(words[4]),
                      std::stoull(words[5]),
                      static_cast<std::uint32_t>(std::stoul(words[6]))});
    }
    return 0;
}
