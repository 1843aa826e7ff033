// Prints what a site on several hosts publishes, as it arrives: for site_faults.sh. Times are
// CLOCK_MONOTONIC in nanoseconds.
//   mesh TIME CAMERAS SPREAD_NS     CAMERAS with a texture; between their first and last capture
//   node TIME HOST SECONDS          from the start of that camera node to its first silhouette
#include "core/app/log.hpp"
#include "core/app/program.hpp"
#include "core/bus/bus.hpp"
#include "core/bus/bus_options.hpp"
#include "core/bus/messages.hpp"

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>

namespace {

using namespace atrium;

template <typename T>
T value(Expected<T> expected) {
    if (expected) return std::move(*expected);
    std::exit(app::fail(expected.error()));
}

long long now_ns() {
    return std::chrono::duration_cast<std::chrono::nanoseconds>(
               std::chrono::steady_clock::now().time_since_epoch())
        .count();
}

void print(const bus::SiteMesh& mesh) {
    const auto [first, last] = std::ranges::minmax_element(
        mesh.texture_frames, {}, [](const bus::FrameKey& key) { return key.capture_time.ns; });
    const long long spread_ns =
        first == mesh.texture_frames.end() ? 0 : (last->capture_time - first->capture_time).count();
    std::printf("mesh %lld %zu %lld\n", now_ns(), mesh.textured_cameras.size(), spread_ns);
}

}  // namespace

int main(int argc, char** argv) {
    const app::StopOnSignal stop;
    bus::BusOptions bus_options;
    config::OptionSet options;
    bus::declare(bus_options, options);
    const app::Start start =
        app::start({.name = "site_watch",
                    .summary = "Prints the meshes and camera nodes of a site on several hosts.",
                    .examples = "  site_watch --world faults\n"},
                   options,
                   argc,
                   argv);
    if (!start.go_on) return start.exit_code;
    const auto participant = value(bus::Participant::create(bus_options));
    auto meshes = value(bus::Reader<bus::SiteMesh>::create(participant));
    auto textures = value(bus::Reader<bus::CameraTexture>::create(participant));
    auto nodes = value(bus::Reader<bus::CameraNodeStatus>::create(participant));
    auto waiter = value(bus::Waiter::create(participant));
    waiter.add(meshes);
    waiter.add(textures);
    waiter.add(nodes);
    const std::stop_callback wake(stop.token(), [&] { waiter.wake(); });
    while (!stop.token().stop_requested()) {
        waiter.wait(std::chrono::seconds(1));
        meshes.take([](bus::SiteMesh&& mesh) { print(mesh); });
        textures.take([](bus::CameraTexture&&) {});  // they load the network as with a viewer
        nodes.take([](bus::CameraNodeStatus&& node) {
            std::printf("node %lld %s %.3f\n", now_ns(), node.host.c_str(), node.first_output_s);
        });
        std::fflush(stdout);
    }
    return 0;
}
