#pragma once

#include "world_server/config.hpp"
#include "world_server/person_preparation.hpp"
#include "world_server/site_register.hpp"

#include <atomic>
#include <cstdint>
#include <functional>
#include <set>
#include <string>

namespace atrium::world_server {

/// Receives sites and their people: gives arriving sites their places, passes on their meshes, and
/// ends people whose site or mesh is gone. No network. Used by one thread, except for
/// `num_present`.
class Reception {
public:
    using Place = std::function<void(const bus::SitePlacement&)>;
    using Reject = std::function<void(const std::string& why)>;

    /// Calls `place` for each site that gets a place, and `reject` with the reason if the world is
    /// full. Both run in the calling thread. `preparation` must outlive this.
    Reception(const WorldServerConfig& config,
              PersonPreparation& preparation,
              Place place,
              Reject reject);

    void put(const bus::SiteDescription& description);
    void end(const bus::SiteDescription& gone);
    /// `written`: by the clock of the site.
    void put(bus::SiteMesh&& mesh, Timestamp written);
    void end(const bus::SiteMesh& gone);

    /// Number of sites that are present. Thread-safe.
    std::uint64_t num_present() const { return num_present_; }

private:
    bool arrive(const std::string& site);
    void leave(const std::string& site);

    const physics::PersonShapeOptions person_;
    PersonPreparation& preparation_;
    const Place place_;
    const Reject reject_;
    SiteRegister sites_;
    std::set<std::string> described_sites_;
    // Sites whose description was disposed and that have not been heard since. Their last meshes
    // may still wait to be taken.
    std::set<std::string> ended_sites_;
    std::atomic<std::uint64_t> num_present_{0};
};

}  // namespace atrium::world_server
