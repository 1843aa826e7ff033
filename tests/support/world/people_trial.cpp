#include "tests/support/world/people_trial.hpp"

#include <cassert>
#include <cmath>

namespace atrium::test {
namespace {

Timestamp at(double time_s) {
    return {1'000'000'000'000 + static_cast<std::int64_t>(std::llround(1e9 * time_s))};
}

}  // namespace

PeopleTrial::PeopleTrial(physics::World& world,
                         double tick_s,
                         std::vector<Player> players,
                         const physics::PersonShapeOptions& options)
    : world_(world), tick_s_(tick_s), players_(std::move(players)), num_sent_(players_.size(), 0) {
    for (const Player& player : players_) readers_.emplace_back(player.world_from_site, options);
}

void PeopleTrial::deliver(std::size_t i, double time_s) {
    const Player& player = players_[i];
    while (num_sent_[i] < player.film->frames.size() &&
           player.film->frames[num_sent_[i]].capture_s <= time_s) {
        const HullFilm::Frame& frame = player.film->frames[num_sent_[i]];
        bus::SiteMesh message;
        message.site = player.site;
        message.frame_id = ++num_sent_[i];
        message.capture_time = at(frame.capture_s);
        message.draco = frame.draco;
        const auto shape = readers_[i].read(message);
        if (!shape)
            refused_.push_back(shape.error().message);
        else if (*shape)
            world_.set_person(player.site, **shape);
        else
            world_.remove_person(player.site);
    }
}

void PeopleTrial::run(double seconds, const std::function<void(double)>& after_tick) {
    while (static_cast<double>(num_ticks_) * tick_s_ < seconds) {
        for (std::size_t i = 0; i < players_.size(); ++i)
            deliver(i, static_cast<double>(num_ticks_) * tick_s_);
        world_.tick();
        ++num_ticks_;
        after_tick(static_cast<double>(num_ticks_) * tick_s_);
    }
}

physics::RigidState state_of(const physics::World& world, std::uint32_t id) {
    std::vector<physics::RigidState> states;
    world.get_states(states);
    for (const physics::RigidState& state : states) {
        if (state.id == id) return state;
    }
    assert(false);
    return {};
}

}  // namespace atrium::test
