#pragma once

#include "core/base/expected.hpp"
#include "core/geometry/pinhole_camera.hpp"
#include "core/geometry/triangle_mesh.hpp"
#include "core/image/image.hpp"
#include "simulation/person.hpp"
#include "viewer/renderer/person/person_model.hpp"

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string_view>
#include <vector>

namespace atrium::test {

/// The true picture of a person in one camera.
struct TruePicture {
    geometry::CalibratedCamera camera;
    image::YuvImage yuv;
    std::vector<std::uint8_t> bgr;  // packed, rows from the top
    image::Mask mask;               // of the person, as large as the picture

    int width() const { return mask.width; }
    int height() const { return mask.height; }
};

/// Pictures of the built-in person in a simulated room at `time_s`, with their true masks.
Expected<std::vector<TruePicture>> film_room(const std::vector<geometry::CalibratedCamera>& cameras,
                                             const simulation::RoomOptions& options,
                                             double time_s);

/// The first frame of a recording with masks, for all of its cameras.
Expected<std::vector<TruePicture>> load_pictures(const std::filesystem::path& recording);

/// How the viewer gets the pictures of the texturing cameras.
enum class Publishing : std::uint8_t {
    kAsSites,     // at half resolution, through the codec with its usual quality
    kFull,        // likewise, but at full resolution
    kAsTheyWere,  // at full resolution, not coded
};

/// As hull.refine of a site.
enum class Refinement : std::uint8_t { kOff, kRound, kPhoto, kRoundPhoto };
Refinement refinement_named(std::string_view name);  // of other names: kOff

/// A person as a viewer receives it.
struct ReceivedPerson {
    geometry::TriangleMesh mesh;
    std::vector<renderer::CameraPicture> pictures;
};

/// Computes silhouettes, hull and textures from `pictures` with the stages of a site. True masks
/// replace the segmentation. The mesh is the hull, refined on request, without coding.
Expected<ReceivedPerson> receive_person(std::span<const TruePicture> pictures,
                                        Publishing publishing,
                                        Refinement refinement = Refinement::kOff);

}  // namespace atrium::test
