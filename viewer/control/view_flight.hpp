#pragma once

#include "viewer/renderer/drawing/view_camera.hpp"

#include <chrono>
#include <optional>

namespace atrium::viewer {

/// The viewpoint a share in [0, 1] of the way between two others. Turns around the target on the
/// shorter side, at a distance that changes evenly, so it does not pass through the target.
renderer::ViewCamera between(const renderer::ViewCamera& from,
                             const renderer::ViewCamera& to,
                             double share);

/// Moves the camera smoothly to another viewpoint.
class ViewFlight {
public:
    using Clock = std::chrono::steady_clock;
    static constexpr std::chrono::milliseconds kDuration{900};

    void start(const renderer::ViewCamera& from,
               const renderer::ViewCamera& to,
               Clock::time_point now) {
        flight_ = Flight{from, to, now};
    }
    void stop() { flight_.reset(); }
    bool is_on() const { return flight_.has_value(); }
    /// The camera at `now`; `camera` if there is no flight. Ends the flight at its goal.
    renderer::ViewCamera update(const renderer::ViewCamera& camera, Clock::time_point now);

private:
    struct Flight {
        renderer::ViewCamera from;
        renderer::ViewCamera to;
        Clock::time_point since;
    };
    std::optional<Flight> flight_;
};

}  // namespace atrium::viewer
