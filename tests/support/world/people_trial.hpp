#pragma once

#include "tests/support/world/hull_film.hpp"
#include "world_server/physics/world.hpp"
#include "world_server/site_reader.hpp"

#include <functional>
#include <map>
#include <string>
#include <vector>

namespace atrium::test {

/// A person whose site sends the hulls of a film.
struct Player {
    std::string site;
    geometry::RigidTransform world_from_site;
    const HullFilm* film = nullptr;  // must outlive the trial
};

/// Feeds the films of people into a world tick by tick, through the mesh reader of the world
/// server. A hull arrives at the first tick after its capture.
class PeopleTrial {
public:
    /// `world` must outlive this.
    PeopleTrial(physics::World& world,
                double tick_s,
                std::vector<Player> players,
                const physics::PersonShapeOptions& options = {});

    /// Ticks until `seconds`. Calls `after_tick` with the time at the end of each tick.
    void run(double seconds, const std::function<void(double)>& after_tick);

    /// Errors of refused meshes. Empty if none was refused.
    const std::vector<std::string>& refused() const { return refused_; }

private:
    void deliver(std::size_t player, double time_s);

    physics::World& world_;
    double tick_s_;
    std::vector<Player> players_;
    std::vector<std::size_t> num_sent_;
    std::vector<world_server::SiteReader> readers_;  // one per player
    std::vector<std::string> refused_;
    std::int64_t num_ticks_ = 0;
};

/// The state of one object, which must exist.
physics::RigidState state_of(const physics::World& world, std::uint32_t id);

}  // namespace atrium::test
