#pragma once

#include "core/base/expected.hpp"
#include "core/geometry/pinhole_camera.hpp"
#include "tests/support/acted_person.hpp"

#include <cstdint>
#include <filesystem>
#include <vector>

namespace atrium::test {

struct FilmOptions {
    std::vector<geometry::CalibratedCamera> cameras;  // without lens distortion
    double rate_hz = 30.0;
    double first_s = 0.0;   // when the first picture is taken
    double flicker = 0.15;  // see MaskPainter::flicker
    std::uint64_t seed = 1;
};

/// What a site would have sent of an act: per picture the coded hull.
struct HullFilm {
    struct Frame {
        double capture_s = 0.0;
        std::vector<std::uint8_t> draco;  // empty: the cameras see nobody
    };
    std::vector<Frame> frames;
};

/// Takes the act with all cameras through the stages of a site: masks, silhouettes, hull, code. In
/// place of pictures and their segmentation, the masks are drawn from the person's true surface,
/// one pixel at a time, and flicker along their borders. Some 40 ms per instant.
///
/// `cache` is a folder (made if absent) in which films are kept under their act's name, options and
/// `kFilmVersion`; empty: nowhere. Errors: a hull that fails, a film that cannot be written.
Expected<HullFilm> film(const Act& act,
                        const FilmOptions& options,
                        const std::filesystem::path& cache = {});

/// To be raised when what is filmed under the same name changes.
constexpr int kFilmVersion = 3;

}  // namespace atrium::test
