#pragma once

#include "core/geometry/aabb.hpp"
#include "core/geometry/pinhole_camera.hpp"
#include "core/image/image.hpp"

#include <string>
#include <vector>

namespace atrium::bench {

/// Pictures of a room with people in it, whose empty room is known.
struct OccupiedScene {
    std::string name;
    std::vector<geometry::CalibratedCamera> cameras;
    geometry::Aabb bounds_site;
    std::vector<std::vector<image::YuvImage>> pictures;  // [camera][instant]
    std::vector<std::vector<image::YuvImage>> empty;     // [camera][shot]
    std::vector<std::vector<image::Mask>> truth;         // [camera][instant]; empty: unknown
};

/// A recording with `background.*`: `num_instants` pictures spread over all of it.
OccupiedScene recorded_scene(const std::string& folder, std::size_t num_instants);

/// A simulated person of `look` in the rig of a file.
struct OccupiedPlay {
    std::string name;
    std::string look = "ada";
    /// Share of the time that the person spends at one place without a step.
    double still = 0.0;
    bool sways = false;  // while standing: shifts the weight, instead of standing like a statue
    /// Leaves the place only along x, the line of sight of the cameras there.
    bool along_x = false;
    std::size_t num_cameras = 8;
    std::size_t num_instants = 40;
};
OccupiedScene simulated_scene(const std::string& rig, const OccupiedPlay& play);

}  // namespace atrium::bench
