#pragma once

#include "core/base/expected.hpp"
#include "core/geometry/pinhole_camera.hpp"
#include "tests/support/world/acted_person.hpp"

#include <cstdint>
#include <filesystem>
#include <vector>

namespace atrium::test {

struct FilmOptions {
    std::vector<geometry::CalibratedCamera> cameras;  // without lens distortion
    double rate_hz = 30.0;
    double first_s = 0.0;   // time of the first picture
    double flicker = 0.15;  // see MaskPainter::flicker
    std::uint64_t seed = 1;
};

/// The stream of a site for an act: one coded hull per picture.
struct HullFilm {
    struct Frame {
        double capture_s = 0.0;
        std::vector<std::uint8_t> draco;  // empty if the cameras see nobody
    };
    std::vector<Frame> frames;
};

/// Films the act with all cameras through the stages of a site: masks, silhouettes, hull, coding.
/// Masks are drawn from the person's true surface instead of segmenting pictures, and flicker by
/// one pixel along their borders. Takes about 40 ms per instant.
///
/// `cache` is a folder, created if absent. It keeps films under their act's name, the options and
/// `kFilmVersion`. If empty, nothing is kept. Errors: a hull that fails, a film that cannot be
/// written.
Expected<HullFilm> film(const Act& act,
                        const FilmOptions& options,
                        const std::filesystem::path& cache = {});

/// Increase this when films under the same name change.
constexpr int kFilmVersion = 3;

}  // namespace atrium::test
