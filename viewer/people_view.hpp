#pragma once

#include "core/base/statistics.hpp"
#include "viewer/companion.hpp"
#include "viewer/due_people.hpp"
#include "viewer/renderer/scene_renderer.hpp"
#include "viewer/session.hpp"

#include <chrono>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace atrium::viewer {

/// How much is left of a person of whom nothing new has come for a while: 1 at first, then less,
/// so that nobody takes a picture of the past for somebody who stands still.
double opacity_after(std::chrono::nanoseconds silence);

/// For people to read: who is there, how fast, and since when nothing new came.
struct SiteLine {
    std::string text;
    bool is_warning = false;
};

/// The people of the world on their way from the bus to the picture. Of the drawing thread.
class PeopleView {
public:
    using Clock = std::chrono::steady_clock;

    /// Shows whom the session has: without an `instant` the newest of each site, with one what was
    /// captured then. A site of which nothing comes any more fades.
    void update(Session& session,
                const std::optional<Timestamp>& instant,
                Clock::time_point now,
                renderer::SceneRenderer& renderer);
    /// Of what is drawn, which ends with its renderer.
    void clear();

    std::size_t size() const { return shown_.size(); }
    std::uint64_t num_pairs_shown() const { return num_pairs_shown_; }
    /// When somebody who is new in a picture was captured, complete and decoded.
    struct JustShown {
        Timestamp captured;
        Clock::time_point complete;
        Clock::time_point ready;
    };
    /// Those who were new in the last `update`.
    const std::vector<JustShown>& just_shown() const { return just_shown_; }
    /// Where they are in the world.
    Companion::Places places(const renderer::SceneRenderer& renderer) const;
    /// How much is seen of somebody who is there, in [0, 1].
    double opacity(const std::string& site, Clock::time_point now) const {
        return opacity_after(now - shown_.at(site).since);
    }
    /// One for each; rates count from the last call on.
    std::vector<SiteLine> lines(Clock::time_point now);

private:
    void show(const std::string& site,
              PersonUpdate update,
              Session& session,
              Clock::time_point now,
              renderer::SceneRenderer& renderer);

    DuePeople due_;
    struct Shown {
        Clock::time_point since;  // when she became as she is
        std::uint64_t num_pairs = 0;
        PersonPlace place_site;
        RateMeter rate;
    };
    std::map<std::string, Shown> shown_;
    std::vector<JustShown> just_shown_;
    std::uint64_t num_pairs_shown_ = 0;
};

}  // namespace atrium::viewer
