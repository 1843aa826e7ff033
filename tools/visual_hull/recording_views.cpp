#include "tools/visual_hull/recording_views.hpp"

#include "site_node/capture/recording_source.hpp"
#include "site_node/silhouette_stage/silhouette_stage.hpp"

#include <string>
#include <utility>

namespace atrium::hull_tool {
namespace {

using site_node::SilhouetteStage;
using site_node::SilhouetteStageOptions;

// A stage for each picture that exists, in their order. All rooms are learned at once, because
// without an empty room each camera needs the pictures of the others.
std::vector<Expected<SilhouetteStage>> make_stages(capture::RecordingSource& source,
                                                   const capture::Metaframe& metaframe,
                                                   const SilhouetteStageOptions& options) {
    std::vector<std::size_t> cameras;
    std::vector<Expected<SilhouetteStage>> stages;
    for (const capture::CameraFrame& picture : metaframe.frames) {
        if (picture.image.empty()) continue;
        cameras.push_back(picture.camera);
        stages.emplace_back(SilhouetteStage(source.rig().cameras[picture.camera], options));
    }
    if (source.has_silhouettes()) return stages;
    return site_node::make_silhouette_stages(source, cameras, options, {});
}

}  // namespace

Expected<SilhouetteStageOptions> read_silhouette_options(const std::filesystem::path& file) {
    SilhouetteStageOptions options;
    if (file.empty()) return options;
    auto reader = config::TableReader::load(file);
    if (!reader) return tl::unexpected(reader.error());
    config::OptionSet set;
    site_node::declare(options, set);
    set.read_file(*reader);
    site_node::read_segmentation(*reader, options);
    for (const char* table : {"segmentation", "silhouette"}) {
        if (auto read = reader->table(table).finish(); !read) return tl::unexpected(read.error());
    }
    return options;
}

Expected<std::vector<views::NamedView>> load_recording_views(
    const std::filesystem::path& folder,
    std::size_t frame,
    const std::vector<std::string>& without,
    const SilhouetteStageOptions& options) {
    capture::RecordingOptions recording;
    recording.folder = folder;
    auto source = capture::RecordingSource::open(recording);
    if (!source) return tl::unexpected(source.error());
    if (auto fits = site_node::check_areas(options, (*source)->rig()); !fits)
        return tl::unexpected(fits.error());
    const auto metaframe = (*source)->read_frame(frame, without);
    if (!metaframe) return tl::unexpected(metaframe.error());

    site_node::PictureSilhouette found;
    std::vector<views::NamedView> views;
    auto stages = make_stages(**source, *metaframe, options);
    auto stage = stages.begin();
    for (const capture::CameraFrame& picture : metaframe->frames) {
        const geometry::CalibratedCamera& camera = (*source)->rig().cameras[picture.camera];
        views.push_back({camera.name, {camera.intrinsics, camera.camera_from_site, {}, {}}});
        if (picture.image.empty()) continue;
        const Expected<void> segmented =
            *stage ? (*stage)->find(picture, {}, found) : tl::unexpected(stage->error());
        ++stage;
        if (!segmented) {
            return make_error(
                segmented.error().kind,
                folder.string() + ": camera \"" + camera.name + "\": " + segmented.error().message);
        }
        views.back().view.contours = found.contours;
    }
    return views;
}

}  // namespace atrium::hull_tool
