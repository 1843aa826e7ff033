#pragma once

#include "viewer/receive/proxy_inbox.hpp"
#include "viewer/renderer/overlay.hpp"

#include <Eigen/Core>

#include <chrono>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

namespace atrium::viewer {

/// Draws the physics proxies of people and models as lines. Drawing thread only.
class ProxyView {
public:
    using Clock = std::chrono::steady_clock;

    /// Applies the changes. Drops a person without an update for one second.
    void update(ProxyChanges changes, Clock::time_point now);
    void clear();

    /// Appends each surfel as a short line along its normal, and a second line for its motion in
    /// the next 100 ms if it moves. Both have the colour of the speed: blue at rest, then green,
    /// yellow, red. Appends a cross for each contact.
    void append_people(std::vector<renderer::Line>& lines) const;

    /// Appends the edges of an object's convex parts. Returns false if they are not known.
    bool append_edges(std::uint32_t object,
                      const Eigen::Matrix4d& world_from_object,
                      const Eigen::Vector3f& colour,
                      std::vector<renderer::Line>& lines) const;

private:
    struct Person {
        bus::PersonProxy proxy;
        Clock::time_point came;
    };
    std::map<std::string, Person> people_;
    std::map<std::uint32_t, bus::ObjectProxy> objects_;
};

/// Colour of a speed, sRGB in [0, 1].
Eigen::Vector3f colour_of_speed(double speed_mps);

}  // namespace atrium::viewer
