#pragma once

#include "viewer/renderer/overlay.hpp"

#include <Eigen/Core>

#include <chrono>
#include <map>
#include <memory>
#include <string>
#include <vector>

namespace atrium::viewer {

/// The names of people over their heads. Knows no renderer: it says what is where.
class NameTags {
public:
    using Clock = std::chrono::steady_clock;

    struct Person {
        Eigen::Vector3d top_world;  // of the head
        double opacity = 1.0;       // how much is seen of her
    };

    /// One label for each person but `hidden`, who has the eye of the picture. The farther from the
    /// eye, the fainter; they follow the heads without the flicker of a hull's top.
    std::vector<renderer::Label> update(const std::map<std::string, Person>& people,
                                        const std::string& hidden,
                                        const Eigen::Vector3d& eye_world,
                                        Clock::time_point now);

private:
    struct Tag {
        std::shared_ptr<const renderer::TexturePicture> picture;
        Eigen::Vector3d top_world;
    };
    std::map<std::string, Tag> tags_;
    Clock::time_point time_;
};

}  // namespace atrium::viewer
