#pragma once

#include "tools/calibrate/sweep/camera_links.hpp"
#include "tools/calibrate/sweep/covered_fields.hpp"
#include "tools/calibrate/sweep/detect_lights.hpp"
#include "tools/calibrate/sweep/fixed_spots.hpp"
#include "tools/calibrate/wand/label_lights.hpp"
#include "tools/calibrate/wand/light_points.hpp"
#include "tools/calibrate/wand/solve_wand.hpp"

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace atrium::calibrate {

/// What a camera has seen of a sweep.
struct CameraTally {
    explicit CameraTally(const NominalCamera& camera) : covered(camera.width, camera.height) {}

    CoveredFields covered;  // by the wand at instants that count
    std::size_t num_pictures = 0;
    std::size_t num_with_lights = 0;         // pictures with a light that moves
    std::size_t num_instants = 0;            // that count, and show it the whole wand
    std::vector<Eigen::Vector2d> wand_px;    // in the last picture
    std::vector<Eigen::Vector2d> others_px;  // other spots in the last picture
    double background = 0.0;                 // of the last picture [grey levels]
};

struct TallyOptions {
    std::size_t num_instants = 300;  // that the whole sweep needs
    double rate_hz = 30.0;           // of the pictures
};

/// Counts what a sweep has shown so far, and says what it still lacks. An instant counts if two
/// cameras show the whole wand and it has moved since the last one that counted.
class SweepTally {
public:
    /// Error kConfiguration if pictures do not tell the lights of this wand apart.
    static Expected<SweepTally> make(const Wand& wand,
                                     std::vector<NominalCamera> cameras,
                                     const TallyOptions& options);

    /// Takes the lights of one instant, by camera; nullopt without a picture. `instant` grows.
    void add(std::uint32_t instant, const std::vector<std::optional<DetectedLights>>& seen);

    /// True if enough instants count, each camera has a share of them and of its picture, and all
    /// cameras are linked by instants that they share.
    bool is_complete() const;

    std::size_t num_instants() const { return num_counted_; }
    std::size_t num_needed() const { return options_.num_instants; }
    std::size_t num_needed_of_each() const { return options_.num_instants / 2; }
    const std::vector<CameraTally>& cameras() const { return tallies_; }
    const std::string& name(std::size_t camera) const { return cameras_[camera].nominal.name; }

    /// "120 of 150, sweep its lower left"; empty if this camera has enough.
    std::string need_of(std::size_t camera) const;

    /// "sweep: 212 of 300 instants; north 120 of 150, sweep its lower left; enough: east, west". At
    /// most `most_characters` long, and then without the cameras that need least; 0: all.
    std::string progress(std::size_t most_characters = 0) const;

    /// What was noticed since the last call, each with its cure; repeated every 20 s at most.
    std::vector<std::string> take_warnings();

    /// All points so far, without lamps and reflections that do not move.
    LightPoints points() const;

    /// Why there is nothing to solve; empty if there is.
    std::string why_too_little() const;

private:
    struct Camera {
        NominalCamera nominal;
        FixedSpots fixed;
        std::vector<LightPoint> points;
        std::vector<Eigen::Vector2d> kept_px, counted_px;  // places of the wand back then
        std::array<std::size_t, 4> warned_at{};            // by kind, in instants; 0: never
        std::size_t since_light = 0, since_picture = 0;    // instants
        std::size_t num_bright = 0, num_crowded = 0;       // pictures in a row
    };
    SweepTally(LightLabeller labeller,
               std::vector<NominalCamera> cameras,
               const TallyOptions& options);
    void look(std::size_t camera, const std::optional<DetectedLights>& seen);
    void notice(std::size_t camera, const std::optional<DetectedLights>& seen);
    void warn(std::size_t camera, std::size_t kind, std::string text);
    void count();
    bool has_enough(std::size_t camera) const;

    LightLabeller labeller_;
    TallyOptions options_;
    std::vector<Camera> cameras_;
    std::vector<CameraTally> tallies_;
    CameraLinks links_;
    std::size_t num_added_ = 0, num_counted_ = 0;
    std::vector<std::string> warnings_;
};

}  // namespace atrium::calibrate
