#pragma once

#include "core/base/expected.hpp"
#include "tools/calibrate/adjust/wand.hpp"
#include "tools/calibrate/sweep/detect_lights.hpp"
#include "tools/calibrate/wand/label_lights.hpp"
#include "tools/calibrate/wand/light_points.hpp"
#include "tools/calibrate/wand/solve_wand.hpp"

#include <Eigen/Core>

#include <cstdint>
#include <deque>
#include <optional>
#include <string>
#include <vector>

namespace atrium::calibrate {

/// Waits for a wand that lies still, at one place or, if its lights are on a line, at three. It
/// rests if two cameras or more see it where it was, for some instants in a row.
class RestingWand {
public:
    /// Error kConfiguration if pictures do not tell the lights of this wand apart, or if it has too
    /// few for a floor.
    static Expected<RestingWand> make(const Wand& wand, std::vector<NominalCamera> cameras);

    /// Takes the lights of one instant, by camera; nullopt without a picture.
    void add(const std::vector<std::optional<DetectedLights>>& seen);

    bool is_complete() const { return num_places_ == num_needed_; }
    std::size_t num_places() const { return num_places_; }
    std::size_t num_needed() const { return num_needed_; }

    /// The lights of the wand in the last picture of a camera; none if it does not show them all.
    const std::vector<Eigen::Vector2d>& wand_px(std::size_t camera) const {
        return wand_px_[camera];
    }

    /// Whether many pictures show as many lights as the wand has, and none of them the wand.
    bool sees_other_wand() const { return num_like_ == 0 && num_unlike_ >= kManyUnlike; }

    /// "floor: 1 of 3 places; the wand rests before door, window: 8 of 15 instants".
    std::string progress() const;

    /// The medians of the lights, with their numbers: place 0 is instant 0, and so on.
    const LightPoints& points() const { return points_; }

private:
    static constexpr std::size_t kManyUnlike = 30;

    RestingWand(LightLabeller labeller,
                std::vector<NominalCamera> cameras,
                std::size_t num_needed,
                std::size_t num_lights);
    /// Whether a light has moved by so many pixels in a camera, or none sees the wand that saw it
    /// before.
    bool has_moved(const std::vector<std::vector<Eigen::Vector2d>>& before, double most_px) const;
    void take_place();

    LightLabeller labeller_;
    std::vector<NominalCamera> cameras_;
    std::size_t num_needed_;
    std::size_t num_lights_;
    std::size_t num_like_ = 0, num_unlike_ = 0;                      // pictures with enough lights
    std::vector<std::vector<Eigen::Vector2d>> wand_px_;              // per camera, per light
    std::deque<std::vector<std::vector<Eigen::Vector2d>>> resting_;  // per instant
    std::vector<std::vector<Eigen::Vector2d>> placed_;               // the last place
    std::size_t num_places_ = 0;
    LightPoints points_;
};

}  // namespace atrium::calibrate
