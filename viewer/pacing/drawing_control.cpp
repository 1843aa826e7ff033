#include "viewer/pacing/drawing_control.hpp"

#include "core/app/log.hpp"
#include "core/base/statistics.hpp"

#include <fmt/format.h>

namespace atrium::viewer {
namespace {

constexpr double kHeadlessFps = 30.0;

double best_fps(const ViewConfig& view, double display_hz) {
    if (view.max_fps > 0.0) return view.max_fps;
    return display_hz > 0.0 ? display_hz : kHeadlessFps;
}

}  // namespace

DrawingControl::DrawingControl(const ViewConfig& view,
                               double display_hz,
                               bool is_tile,
                               Session& session,
                               renderer::SceneRenderer& renderer)
    : session_(session),
      renderer_(renderer),
      adapts_(view.adapt != "off"),
      is_tile_(is_tile),
      is_paced_by_display_(view.max_fps == 0.0 && display_hz > 0.0),
      best_{.max_fps = best_fps(view, display_hz),
            .scale = view.scale,
            .has_shadows = view.shadows == "on"},
      adaptive_(best_),
      pacer_(Clock::duration(0), !is_tile && !is_paced_by_display_) {}

Expected<void> DrawingControl::apply() {
    // stay below the rate of a display without vertical synchronisation; one with it sets the pace
    // itself
    const double slack = is_best() && is_paced_by_display_ ? 1.05 : 1.0;
    const auto period = std::chrono::duration_cast<Clock::duration>(
        std::chrono::duration<double>(1.0 / (slack * quality().max_fps)));
    pacer_.set_period(period);
    // a wall plays back with a delay and needs every pair
    session_.set_picture_period(is_best() || is_tile_ ? Clock::duration(0) : period);
    renderer_.set_shadows(quality().has_shadows);
    return renderer_.set_scale(quality().scale);
}

void DrawingControl::note_arrivals() {
    for (const DecodedPeople::Arrival& arrival : session_.take_arrivals())
        pacer_.ready(arrival.site, arrival.at);
}

bool DrawingControl::wait(const std::stop_token& stop) {
    while (!stop.stop_requested()) {
        note_arrivals();
        const Clock::time_point due = pacer_.due();
        if (Clock::now() >= due) return true;
        session_.wait_for_people(stop, due);
    }
    return false;
}

void DrawingControl::began(Clock::time_point at) {
    note_arrivals();
    pacer_.began(at);
}

Expected<void> DrawingControl::adapt(const AdaptiveQuality::Picture& picture) {
    const std::size_t before = adaptive_.level();
    if (!adapts_ || !adaptive_.add(picture)) return {};
    const std::string line = fmt::format("{} reason={} picture_ms={:.1f}",
                                         to_string(quality()),
                                         adaptive_.reason(),
                                         milliseconds(picture.busy));
    if (adaptive_.level() > before)
        app::log::warn("quality_reduced {}", line);
    else
        app::log::info("quality_raised {}", line);
    return apply();
}

Expected<void> DrawingControl::draw_at_best(std::span<const renderer::EyeView> eyes) {
    if (is_best() || eyes.empty()) return {};
    renderer_.set_shadows(best_.has_shadows);
    if (auto scaled = renderer_.set_scale(best_.scale); !scaled) return scaled;
    renderer_.draw(eyes);
    return {};
}

}  // namespace atrium::viewer
