#pragma once

#include "core/base/expected.hpp"
#include "core/base/timestamp.hpp"
#include "core/bus/bus.hpp"
#include "core/geometry/triangle_mesh.hpp"

#include <atomic>
#include <chrono>
#include <functional>
#include <memory>
#include <string>
#include <thread>

namespace atrium::test {

struct MeshSiteOptions {
    std::string name = "site";
    double rate_hz = 30.0;
    /// Time from a capture until the bus gets its mesh: the computation time of a site.
    std::chrono::nanoseconds work{0};
};

/// A site without cameras and pictures. It publishes the surface of a person at each capture, coded
/// as sites do, in real time. Like a site, it skips captures that come too late.
class MeshSite {
public:
    /// Returns a closed mesh in the site's frame. The site's thread calls it with increasing
    /// capture times.
    using MeshAt = std::function<geometry::TriangleMesh(Timestamp capture_time)>;

    static Expected<std::unique_ptr<MeshSite>> start(const bus::BusOptions& options,
                                                     MeshSiteOptions site,
                                                     MeshAt mesh_at);
    /// Makes the site leave: its description and meshes are disposed.
    ~MeshSite() = default;

    std::uint64_t num_published() const { return num_published_; }
    std::uint64_t num_failed() const { return num_failed_; }

private:
    MeshSite(MeshSiteOptions site,
             MeshAt mesh_at,
             bus::Writer<bus::SiteDescription> descriptions,
             bus::Writer<bus::SiteMesh> meshes);
    void run(std::stop_token stop);
    void publish(bus::SiteMesh& mesh);

    const MeshSiteOptions site_;
    const MeshAt mesh_at_;
    bus::Writer<bus::SiteDescription> descriptions_;
    bus::Writer<bus::SiteMesh> meshes_;
    std::atomic<std::uint64_t> num_published_ = 0;
    std::atomic<std::uint64_t> num_failed_ = 0;
    std::jthread thread_;  // destroyed first: it uses the rest
};

}  // namespace atrium::test
