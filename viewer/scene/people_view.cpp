#include "viewer/scene/people_view.hpp"

#include "core/app/log.hpp"

#include <algorithm>
#include <utility>

namespace atrium::viewer {
namespace {

// Sites on narrow networks send five metaframes a second.
constexpr auto kStalled = std::chrono::milliseconds(600);
constexpr auto kFades = std::chrono::milliseconds(800);
constexpr double kLeastOpacity = 0.35;

double seconds(PeopleView::Clock::duration duration) {
    return std::chrono::duration<double>(duration).count();
}

}  // namespace

double opacity_after(std::chrono::nanoseconds silence) {
    const double share = seconds(silence - kStalled) / seconds(kFades);
    return 1.0 - (1.0 - kLeastOpacity) * std::clamp(share, 0.0, 1.0);
}

void PeopleView::show(const std::string& site,
                      PersonUpdate update,
                      Session& session,
                      Clock::time_point now,
                      renderer::SceneRenderer& renderer) {
    if (!update.model) {
        if (shown_.erase(site) > 0) app::log::info("person_gone site={}", site);
        renderer.remove_person(site);
        return;
    }
    const auto [found, is_new] = shown_.try_emplace(site);
    Shown& shown = found->second;
    if (is_new) {
        app::log::info("person_shown site={} triangles={} cameras={}",
                       site,
                       update.model->triangles.size(),
                       update.model->cameras.size());
    }
    // a slow picture is no silence of the site
    if (!is_new && !holds_ && updated_ - shown.since > kStalled)
        app::log::info("person_back site={} after_s={:.1f}", site, seconds(now - shown.since));
    shown.since = now;
    ++shown.num_pairs;
    shown.place_site = place_of(update.model->vertices_site);
    just_shown_.push_back({update.delays_from, update.complete, update.ready});
    session.recycle(renderer.set_person(site, std::move(*update.model)));
    ++num_pairs_shown_;
}

void PeopleView::update(Session& session,
                        const std::optional<Timestamp>& instant,
                        Clock::time_point now,
                        renderer::SceneRenderer& renderer) {
    just_shown_.clear();
    const auto skip = [&](PersonUpdate update) {
        if (update.model) session.skip(std::move(*update.model));
    };
    for (auto& [site, update] : session.take_people()) {
        if (instant)
            due_.add(site, std::move(update), skip);
        else
            show(site, std::move(update), session, now, renderer);
    }
    if (instant) {
        for (auto& [site, update] : due_.take(*instant, skip))
            show(site, std::move(update), session, now, renderer);
    }
    updated_ = now;
    for (const auto& [site, shown] : shown_) renderer.set_person_opacity(site, opacity(site, now));
}

FollowCamera::Places PeopleView::places(const renderer::SceneRenderer& renderer) const {
    FollowCamera::Places places;
    for (const auto& [site, shown] : shown_) {
        const Eigen::Isometry3d world_from_site(renderer.world_from_site(site));
        const bool has_place = !world_from_site.matrix().isIdentity();
        const Eigen::Vector3d front =
            has_place ? Eigen::Vector3d(world_from_site.linear().col(0)) : Eigen::Vector3d::Zero();
        places[site] = {world_from_site * shown.place_site.middle,
                        world_from_site * shown.place_site.eyes,
                        world_from_site * shown.place_site.top,
                        shown.place_site.size,
                        front};
    }
    return places;
}

std::map<std::string, PeopleView::Stream> PeopleView::streams(Clock::time_point now) {
    std::map<std::string, Stream> streams;
    for (auto& [site, shown] : shown_) {
        Stream& stream = streams[site];
        stream.per_s = shown.rate.update(shown.num_pairs, now);
        if (!holds_ && updated_ - shown.since > kStalled)
            stream.silent_s = seconds(updated_ - shown.since);
    }
    return streams;
}

void PeopleView::clear() {
    due_.clear();
    shown_.clear();
    just_shown_.clear();
}

}  // namespace atrium::viewer
