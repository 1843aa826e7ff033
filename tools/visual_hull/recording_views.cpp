#include "tools/visual_hull/recording_views.hpp"

#include "site_node/capture/recording_source.hpp"
#include "site_node/silhouette_stage/silhouette_stage.hpp"

#include <string>
#include <utility>

namespace atrium::hull_tool {
namespace {

using site_node::SilhouetteStage;
using site_node::SilhouetteStageOptions;

Expected<SilhouetteStage> make_stage(capture::RecordingSource& source,
                                     const capture::CameraFrame& picture,
                                     const SilhouetteStageOptions& options) {
    if (picture.silhouette != nullptr)
        return SilhouetteStage(source.rig().cameras[picture.camera], options);
    auto stages = site_node::make_silhouette_stages(source, {picture.camera}, options, {});
    return std::move(stages.front());
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
    for (const capture::CameraFrame& picture : metaframe->frames) {
        const geometry::CalibratedCamera& camera = (*source)->rig().cameras[picture.camera];
        views.push_back({camera.name, {camera.intrinsics, camera.camera_from_site, {}, {}}});
        if (picture.image.empty()) continue;
        const auto segmented =
            make_stage(**source, picture, options).and_then([&](SilhouetteStage&& stage) {
                return stage.find(picture, {}, found);
            });
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
