#pragma once

#include "viewer/overlay/text_picture.hpp"
#include "viewer/renderer/overlay.hpp"

#include <Eigen/Core>

#include <chrono>
#include <map>
#include <memory>
#include <string>
#include <vector>

namespace atrium::viewer {

/// Places the names of people over their heads. Knows no renderer.
class NameTags {
public:
    using Clock = std::chrono::steady_clock;

    struct Person {
        Eigen::Vector3d top_world;  // top of the head
        double opacity = 1.0;       // of the person, in [0, 1]
    };

    /// Returns one label per person except `hidden`, whose eye the picture is drawn from. Labels
    /// fade with the distance to the eye, and follow the heads smoothly because the top of a hull
    /// flickers.
    std::vector<renderer::Label> update(const std::map<std::string, Person>& people,
                                        const std::string& hidden,
                                        const Eigen::Vector3d& eye_world,
                                        Clock::time_point now);
    /// Size of the names: share of the picture's height, and height of their pictures.
    void set_size(double share, int text_px) {
        height_ = share;
        text_px_ = text_px;
    }
    static constexpr double kHeight = 0.05;  // letters have half of it

private:
    struct Tag {
        int text_px = 0;
        std::shared_ptr<const renderer::TexturePicture> picture;
        Eigen::Vector3d top_world;
    };
    double height_ = kHeight;
    int text_px_ = kTextHeight_px;
    std::map<std::string, Tag> tags_;
    Clock::time_point time_;
};

}  // namespace atrium::viewer
