#include "site_node/silhouette_stage/silhouette_stage_options.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

namespace atrium::site_node {
namespace {

constexpr config::Range kPixel{-1e5, 1e5};

CameraAreas read_areas(config::TableReader& table) {
    CameraAreas camera;
    table.require("name");
    table.read("name", camera.name);
    for (const auto& [key, polygons] :
         {std::pair{"include", &camera.areas.include}, {"exclude", &camera.areas.exclude}}) {
        if (!table.has(key)) continue;
        segmentation::AreaPolygon polygon;
        table.read(key, polygon, kPixel);
        if (polygon.size() < 3) table.reject(key, "must have at least 3 corners [x, y]");
        polygons->push_back(std::move(polygon));
    }
    return camera;
}

}  // namespace

void declare(SilhouetteStageOptions& options, config::OptionSet& set) {
    segmentation::SegmentationOptions& segmentation = options.segmentation;
    set.add("segmentation.max_chroma_distance",
            segmentation.max_chroma_distance,
            "Mahalanobis distance up to which chroma counts as background [sigma]",
            {0.5, 50});
    set.add("segmentation.min_chroma_sigma",
            segmentation.min_chroma_sigma,
            "noise floor of background chroma, added to the learned deviation [grey levels]",
            {1, 20});
    set.add("segmentation.darkest_shadow",
            segmentation.darkest_shadow,
            "smallest fraction of its luma that a surface keeps in shadow",
            {0.05, 1});
    set.add("segmentation.darkest_coloured_shadow",
            segmentation.darkest_coloured_shadow,
            "like darkest_shadow, where the hue distinguishes a shadow from a dark object",
            {0.05, 1});
    set.add("segmentation.max_highlight",
            segmentation.max_highlight,
            "largest fraction by which a surface may brighten",
            {0, 1});
    set.add("segmentation.max_luma_distance",
            segmentation.max_luma_distance,
            "luma difference that counts as noise [sigma]",
            {0.5, 50});
    set.add("segmentation.min_luma_sigma",
            segmentation.min_luma_sigma,
            "lower limit of the luma deviation [grey levels]",
            {0.1, 50});
    set.add("segmentation.dark_luma",
            segmentation.dark_luma,
            "luma below which chroma is ignored [grey levels]",
            {0, 255});
    set.add("segmentation.max_gain_change",
            segmentation.max_gain_change,
            "flickering light: largest fraction by which picture brightness is compensated; 0: off",
            {0, 0.45});
    set.add(
        "segmentation.drift_frames",
        segmentation.drift_frames,
        "drifting light: time constant with which the background model follows [pictures]; 0: off",
        {0, 1e6});
    set.add("segmentation.max_drift",
            segmentation.max_drift,
            "largest drift that the background model follows [grey levels of luma]",
            {0, 255});
    set.add("segmentation.refine_outline",
            segmentation.refine_outline,
            "decides the pixels at the outline of people by the colours beside them");
    set.add("segmentation.min_area_px",
            segmentation.min_area_px,
            "specks smaller than this are removed [px]",
            {0, 1e6});
    set.add("segmentation.max_hole_px",
            segmentation.max_hole_px,
            "holes smaller than this are filled [px]",
            {0, 1e6});
    set.add("segmentation.background_folder",
            options.background.folder,
            "folder for the results of --learn-background; empty: learn at every start");
    set.add(
        "segmentation.background_from",
        options.background.from,
        "pictures to learn the empty room from: of the \"empty\" room, or of the room with "
        "\"people\" in it; auto: of the empty room, or of a recording without background.* with "
        "people",
        {"auto", "empty", "people"});
    set.add("segmentation.background_frames",
            options.background.num_frames,
            "pictures to learn from, per camera; 0: of the empty room all that a recording or "
            "simulated room has and 60 from live cameras; with people 100 over the whole recording",
            {0, 60000});
    set.add("segmentation.background_watch_s",
            options.background.watch_s,
            "with people: how long live cameras or a simulated room are watched [s]",
            {1, 3600});
    set.add("segmentation.worker",
            options.worker.socket,
            "socket of a segmentation worker, a process of somebody else that finds the people; "
            "empty: the built-in segmentation alone");
    set.add("segmentation.worker_deadline_ms",
            options.worker.deadline_ms,
            "how long a picture waits for the worker, before it takes the mask of the built-in "
            "segmentation [ms]",
            {1, 10000});

    silhouette::SilhouetteOptions& silhouette = options.silhouette;
    set.add("silhouette.tolerance_px",
            silhouette.tolerance_px,
            "width of the blurred segments [px]",
            {0.25, 20});
    set.add("silhouette.min_area_px",
            silhouette.min_area_px,
            "blobs and holes smaller than this are ignored [px]",
            {0, 1e6});
}

void read_segmentation(config::TableReader& reader, SilhouetteStageOptions& options) {
    config::TableReader table = reader.table("segmentation");
    for (config::TableReader& camera : table.tables("camera"))
        options.areas.push_back(read_areas(camera));
}

Expected<void> check_areas(const SilhouetteStageOptions& options, const config::Rig& rig) {
    for (const CameraAreas& camera : options.areas) {
        const bool known = std::any_of(rig.cameras.begin(), rig.cameras.end(), [&](const auto& c) {
            return c.name == camera.name;
        });
        if (known) continue;
        return make_error(
            ErrorKind::kConfiguration,
            fmt::format("segmentation.camera: the rig has no camera '{}'", camera.name));
    }
    return {};
}

segmentation::SegmentationAreas areas_of(const std::vector<CameraAreas>& areas,
                                         const std::string& name) {
    segmentation::SegmentationAreas sum;
    for (const CameraAreas& camera : areas) {
        if (camera.name != name) continue;
        sum.include.insert(
            sum.include.end(), camera.areas.include.begin(), camera.areas.include.end());
        sum.exclude.insert(
            sum.exclude.end(), camera.areas.exclude.begin(), camera.areas.exclude.end());
    }
    return sum;
}

}  // namespace atrium::site_node
