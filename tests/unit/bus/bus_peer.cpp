#include "core/bus/bus.hpp"

#include <cstdio>
#include <cstdlib>
#include <string>

/// Announces a site once and sends a mesh every 50 ms until it is killed: bus_peer <domain> <world>
/// <site>.
int main(int argc, char** argv) {
    using namespace atrium::bus;
    if (argc != 4) return 2;
    BusOptions options;
    options.domain = static_cast<std::uint32_t>(std::strtoul(argv[1], nullptr, 10));
    options.world = argv[2];
    const auto participant = Participant::create(options);
    if (!participant) {
        std::fprintf(stderr, "%s\n", participant.error().message.c_str());
        return 1;
    }
    auto descriptions = Writer<SiteDescription>::create(*participant);
    auto meshes = Writer<SiteMesh>::create(*participant);
    auto pace = Waiter::create(*participant);
    if (!descriptions || !meshes || !pace) return 1;

    SiteDescription description;
    description.site = argv[3];
    description.bounds_site.add({-1, -1, 0});
    description.bounds_site.add({1, 1, 2});
    if (!descriptions->write(description)) return 1;
    SiteMesh mesh;
    mesh.site = argv[3];
    mesh.draco.assign(30'000, 1);
    for (;; ++mesh.frame_id) {
        mesh.capture_time = atrium::Timestamp::now();
        if (!meshes->write(mesh)) return 1;
        pace->wait(std::chrono::milliseconds(50));
    }
}
