#pragma once

#include "viewer/proxy_inbox.hpp"
#include "viewer/renderer/overlay.hpp"

#include <Eigen/Core>

#include <chrono>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

namespace atrium::viewer {

/// What people and models are to the physics, as lines. Of the drawing thread.
class ProxyView {
public:
    using Clock = std::chrono::steady_clock;

    /// A person of whom nothing has come for a second is forgotten.
    void update(ProxyChanges changes, Clock::time_point now);
    void clear();

    /// Each surfel as a short line out of the surface, and as another one its way in the next
    /// 100 ms where it moves, both in the colour of its speed: blue at rest, then green, yellow and
    /// red. Crosses where somebody touches something.
    void append_people(std::vector<renderer::Line>& lines) const;

    /// The edges of an object's parts; false: they are not known.
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

/// sRGB in [0, 1].
Eigen::Vector3f colour_of_speed(double speed_mps);

}  // namespace atrium::viewer
