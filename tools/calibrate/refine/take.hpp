#pragma once

#include "core/base/expected.hpp"
#include "core/geometry/pinhole_camera.hpp"
#include "site_node/coherence/tangency.hpp"
#include "site_node/views/named_view.hpp"

#include <cstddef>
#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <vector>

namespace atrium::calibrate {

/// The silhouettes of a recording at instants that are spread over it.
struct Take {
    std::vector<coherence::Sight> sights;  // in the order of time, of the rig's cameras
    /// Per sight: the silhouettes of the rig's cameras that have a picture, by name.
    std::vector<std::vector<views::NamedView>> views;
    std::size_t num_instants = 0;  // of the recording
    double rate_hz = 0.0;          // 0: unknown
};

struct TakeOptions {
    std::size_t most_sights = 160;
    /// Called with a short text while it reads, or null.
    std::function<void(const std::string&)> report;
};

/// Reads the silhouettes of the cameras of a rig from a recording with pictures of these names: its
/// masks if it has any, else people are told from the empty room as site_node does. Of each instant
/// the one before is read, too. The rig's lenses count, not those of the recording. Errors: a
/// camera without pictures, or with pictures of another size, and those of the recording.
///
/// A folder with `views/` and no rig.toml has the polygons that a site found: of its
/// KeptSilhouettes, or of `site_node --write-silhouettes`. Its lenses must be those of the rig.
Expected<Take> read_take(const std::filesystem::path& recording,
                         std::span<const geometry::CalibratedCamera> rig,
                         const TakeOptions& options);

/// The share of the silhouettes that the hull of these cameras explains, the mean over the sights
/// with these numbers (rig_check::measure_agreement).
double coverage_of(const Take& take,
                   std::span<const std::size_t> sights,
                   std::span<const geometry::CalibratedCamera> cameras);

}  // namespace atrium::calibrate
