#include "tests/support/network/mesh_site.hpp"

#include "core/codec/mesh_codec.hpp"

#include <condition_variable>
#include <mutex>
#include <utility>

namespace atrium::test {
namespace {

using Clock = std::chrono::steady_clock;

// Returns false once a stop is requested.
bool wait_until(Clock::time_point time, const std::stop_token& stop) {
    std::mutex mutex;
    std::condition_variable_any never;
    std::unique_lock lock(mutex);
    never.wait_until(lock, stop, time, [] { return false; });
    return !stop.stop_requested();
}

}  // namespace

Expected<std::unique_ptr<MeshSite>> MeshSite::start(const bus::BusOptions& options,
                                                    MeshSiteOptions site,
                                                    MeshAt mesh_at) {
    auto participant = bus::Participant::create(options);
    if (!participant) return tl::unexpected(participant.error());
    auto descriptions = bus::Writer<bus::SiteDescription>::create(*participant);
    if (!descriptions) return tl::unexpected(descriptions.error());
    auto meshes = bus::Writer<bus::SiteMesh>::create(*participant);
    if (!meshes) return tl::unexpected(meshes.error());
    return std::unique_ptr<MeshSite>(new MeshSite(
        std::move(site), std::move(mesh_at), std::move(*descriptions), std::move(*meshes)));
}

MeshSite::MeshSite(MeshSiteOptions site,
                   MeshAt mesh_at,
                   bus::Writer<bus::SiteDescription> descriptions,
                   bus::Writer<bus::SiteMesh> meshes)
    : site_(std::move(site)),
      mesh_at_(std::move(mesh_at)),
      descriptions_(std::move(descriptions)),
      meshes_(std::move(meshes)),
      thread_([this](std::stop_token stop) { run(stop); }) {}

void MeshSite::run(std::stop_token stop) {
    bus::SiteDescription description;
    description.site = site_.name;
    description.bounds_site.add({-2.0, -2.0, -0.1});
    description.bounds_site.add({2.0, 2.0, 2.5});
    if (!descriptions_.write(description)) ++num_failed_;
    bus::SiteMesh mesh;
    mesh.site = site_.name;
    const std::chrono::nanoseconds period(static_cast<std::int64_t>(1e9 / site_.rate_hz));
    Clock::time_point capture = Clock::now();
    while (wait_until(capture, stop)) {
        mesh.capture_time = Timestamp::now();
        ++mesh.frame_id;
        mesh.draco.clear();
        const auto shape = mesh_at_(mesh.capture_time);
        if (!shape.empty() && !codec::MeshEncoder().encode(shape, {}, mesh.draco)) ++num_failed_;
        if (!wait_until(capture + site_.work, stop)) break;
        publish(mesh);
        do capture += period;
        while (capture < Clock::now());
    }
    if (!descriptions_.dispose(description)) ++num_failed_;
}

void MeshSite::publish(bus::SiteMesh& mesh) {
    if (meshes_.write(mesh))
        ++num_published_;
    else
        ++num_failed_;
}

}  // namespace atrium::test
