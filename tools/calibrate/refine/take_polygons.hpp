#pragma once

#include "tools/calibrate/refine/take.hpp"

namespace atrium::calibrate {

/// True for a folder with `views/` and no rig.toml.
bool has_polygons(const std::filesystem::path& folder);

/// Reads `views/NUMBER.json` of such a folder. Numbers that follow each other are instants in a
/// row: of these, up to `most_sights` that have one before them are used, spread evenly.
///
/// Errors kConfiguration and kNotFound name the file: damaged, or with silhouettes of other lenses
/// than the rig's. A camera may lack in some files, but not in all.
Expected<Take> read_polygons(const std::filesystem::path& folder,
                             std::span<const geometry::CalibratedCamera> rig,
                             const TakeOptions& options);

}  // namespace atrium::calibrate
