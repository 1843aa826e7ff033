#pragma once

#include "core/recording/world_writer.hpp"
#include "tests/unit/renderer/synthetic_person.hpp"
#include "tools/export/formats/frame.hpp"
#include "viewer/renderer/person/person_model.hpp"

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace atrium::exporting::testing {

/// Two balls, one partly before the other, in colours that change softly with the place.
std::vector<renderer::synthetic::Sphere> balls();
Eigen::Vector3d colour_at(const Eigen::Vector3d& p_site);
std::vector<geometry::CalibratedCamera> ball_cameras();
std::vector<renderer::CameraPicture> ball_pictures();

/// As a viewer has it, seen by `ball_cameras`; the last camera looks from above.
renderer::PersonModel ball_model(int num_rings = 24);

/// Largest distance of a point from the surface of the balls.
double off_surface_m(const Eigen::Vector3d& p_site);

ExportFacts facts();
FrameTime frame_time(std::size_t number);

inline constexpr Timestamp kBegin{1'700'000'000'000'000'000};
/// Writes a recording of one site whose person is the balls, at 20 frames a second, moved up by
/// 1 cm from frame to frame. `has_placement`: turned by 90 degrees and 5 m along x in the world.
struct BallRecording {
    int num_frames = 6;
    bool has_placement = true;
    bool lacks_textures_of_frame_3 = false;
    bool is_empty_at_frame_2 = false;
};
void write_balls(const std::filesystem::path& file,
                 const std::string& site,
                 const BallRecording& content);

std::vector<std::uint8_t> bytes_of(const std::filesystem::path& file);
/// Files of a folder, sorted by name.
std::vector<std::string> names_in(const std::filesystem::path& folder);

}  // namespace atrium::exporting::testing
