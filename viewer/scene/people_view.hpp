#pragma once

#include "core/base/statistics.hpp"
#include "viewer/control/follow_camera.hpp"
#include "viewer/control/site_selection.hpp"
#include "viewer/receive/delayed_people.hpp"
#include "viewer/receive/session.hpp"
#include "viewer/renderer/scene_renderer.hpp"

#include <chrono>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace atrium::viewer {

/// Opacity of a person after a time without updates: 1 at first, then less, so the user does not
/// mistake an old picture for a person who stands still.
double opacity_after(std::chrono::nanoseconds silence);

/// A line of text for the HUD.
struct HudLine {
    std::string text;
    bool is_warning = false;
};

/// Moves people from the session to the renderer. Drawing thread only.
class PeopleView {
public:
    using Clock = std::chrono::steady_clock;

    /// Shows the people of the session: the newest update of each site, or with `instant` the one
    /// captured then. People fade while their site is silent.
    void update(Session& session,
                const std::optional<Timestamp>& instant,
                Clock::time_point now,
                renderer::SceneRenderer& renderer);
    /// Draws only the people that `sites` shows, without `inside`, through whose eyes the camera
    /// looks (empty: nobody). Takes effect with the next `update`.
    void show_only(const SiteSelection& sites, const std::string& inside) {
        selected_ = sites;
        inside_ = inside;
    }
    /// People stay as they are while their sites are silent: a recording stands still.
    void hold(bool holds) { holds_ = holds; }
    /// Drops everything; call it when the renderer is destroyed.
    void clear();

    std::size_t size() const { return shown_.size(); }
    std::uint64_t num_pairs_shown() const { return num_pairs_shown_; }
    /// Times of a person who is new in a picture.
    struct JustShown {
        Timestamp delays_from;  // its capture, see bus::delays_from
        Clock::time_point complete;
        Clock::time_point ready;
    };
    /// People new in the last `update`.
    const std::vector<JustShown>& just_shown() const { return just_shown_; }
    /// Positions in the world.
    FollowCamera::Places places(const renderer::SceneRenderer& renderer) const;
    /// Those of people whom the user does not hide.
    FollowCamera::Places not_hidden(FollowCamera::Places places) const {
        std::erase_if(places, [this](const auto& of) { return !selected_.shows(of.first); });
        return places;
    }
    /// Whether the user wants to see the site's person.
    bool is_drawn(const std::string& site) const {
        return site != inside_ && selected_.shows(site);
    }
    /// Opacity of a person of this session, in [0, 1]. 0: not drawn.
    double opacity(const std::string& site, Clock::time_point now) const {
        if (!is_drawn(site)) return 0.0;
        return holds_ ? 1.0 : opacity_after(now - shown_.at(site).since);
    }
    /// A person's stream.
    struct Stream {
        double per_s = 0.0;     // new meshes, since the last call
        double silent_s = 0.0;  // 0 while people are held; time without a new one at the last
                                // picture; 0 while they come
    };
    std::map<std::string, Stream> streams(Clock::time_point now);

private:
    void show(const std::string& site,
              PersonUpdate update,
              Session& session,
              Clock::time_point now,
              renderer::SceneRenderer& renderer);

    DelayedPeople due_;
    SiteSelection selected_;
    std::string inside_;
    bool holds_ = false;
    struct Shown {
        Clock::time_point since;  // last update
        std::uint64_t num_pairs = 0;
        PersonPlace place_site;
        RateMeter rate;
    };
    std::map<std::string, Shown> shown_;
    Clock::time_point updated_;  // last picture
    std::vector<JustShown> just_shown_;
    std::uint64_t num_pairs_shown_ = 0;
};

}  // namespace atrium::viewer
