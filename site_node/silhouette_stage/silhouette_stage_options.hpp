#pragma once

#include "core/base/expected.hpp"
#include "core/config/option_set.hpp"
#include "core/config/rig.hpp"
#include "core/config/table_reader.hpp"
#include "site_node/segmentation/areas.hpp"
#include "site_node/segmentation/segmentation_options.hpp"
#include "site_node/segmentation_worker/worker_client.hpp"
#include "site_node/silhouette/silhouette.hpp"
#include "site_node/silhouette_stage/backgrounds.hpp"

#include <string>
#include <vector>

namespace atrium::site_node {

/// Areas in the pictures of one camera in which segmentation looks for people.
struct CameraAreas {
    std::string name;  // the camera's
    segmentation::SegmentationAreas areas;
};

/// `[segmentation]` and `[silhouette]` of a site file: the options from a picture to its contours.
struct SilhouetteStageOptions {
    segmentation::SegmentationOptions segmentation;
    BackgroundOptions background;
    segmentation_worker::WorkerOptions worker;
    std::vector<CameraAreas> areas;
    silhouette::SilhouetteOptions silhouette;
};

/// Declares every option with its default; `options` must outlive `set`.
void declare(SilhouetteStageOptions& options, config::OptionSet& set);

/// Reads the areas of `[[segmentation.camera]]`, which are not options. `reader` collects the
/// errors.
void read_segmentation(config::TableReader& reader, SilhouetteStageOptions& options);

/// Checks that every area names a camera of this rig.
Expected<void> check_areas(const SilhouetteStageOptions& options, const config::Rig& rig);

/// Returns the areas of camera `name`, merged over all its entries; without an entry the whole
/// picture counts.
segmentation::SegmentationAreas areas_of(const std::vector<CameraAreas>& areas,
                                         const std::string& name);

}  // namespace atrium::site_node
