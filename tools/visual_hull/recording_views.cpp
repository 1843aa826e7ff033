#include "tools/visual_hull/recording_views.hpp"

#include "site_node/capture/recording_source.hpp"
#include "site_node/segmentation/segmentation.hpp"
#include "site_node/silhouette/silhouette.hpp"

#include <string>
#include <utility>

namespace atrium::hull_tool {
namespace {

Expected<image::Mask> segment_by_background(capture::RecordingSource& source,
                                            const capture::CameraFrame& frame) {
    const segmentation::SegmentationOptions options;
    segmentation::BackgroundLearner learner;
    Expected<void> added;
    const auto learn = [&](std::size_t, const image::YuvView& picture) {
        added = learner.add(picture);
        return added.has_value();
    };
    for (const auto& shown : source.show_background({frame.camera}, learn, {})) {
        if (!shown) return tl::unexpected(shown.error());
    }
    if (!added) return tl::unexpected(added.error());
    Expected<segmentation::BackgroundStatistics> room = learner.finish();
    if (!room) return tl::unexpected(room.error());
    segmentation::Segmenter segmenter(std::move(*room), options);
    image::Mask mask;
    image::YuvImage buffer;
    const image::YuvView picture = image::working_view(frame.image, buffer);
    if (auto done = segmenter.segment(picture, mask); !done) return tl::unexpected(done.error());
    return mask;
}

}  // namespace

Expected<std::vector<views::NamedView>> load_recording_views(
    const std::filesystem::path& folder,
    std::size_t frame,
    const std::vector<std::string>& without) {
    capture::RecordingOptions options;
    options.folder = folder;
    auto source = capture::RecordingSource::open(options);
    if (!source) return tl::unexpected(source.error());
    const auto metaframe = (*source)->read_frame(frame, without);
    if (!metaframe) return tl::unexpected(metaframe.error());

    const silhouette::SilhouetteOptions silhouette_options;
    silhouette::SilhouetteScratch scratch;
    std::vector<silhouette::SilhouettePolygon> polygons;
    std::vector<views::NamedView> views;
    for (const capture::CameraFrame& picture : metaframe->frames) {
        const geometry::CalibratedCamera& camera = (*source)->rig().cameras[picture.camera];
        if (picture.image.empty()) {
            views.push_back({camera.name, {camera.intrinsics, camera.camera_from_site, {}, {}}});
            continue;
        }
        const auto name_camera = [&](const Error& error) {
            return make_error(
                error.kind, folder.string() + ": camera \"" + camera.name + "\": " + error.message);
        };
        image::Mask learned;
        if (picture.silhouette == nullptr) {
            Expected<image::Mask> segmented = segment_by_background(**source, picture);
            if (!segmented) return name_camera(segmented.error());
            learned = std::move(*segmented);
        }
        const image::Mask& mask = picture.silhouette != nullptr ? *picture.silhouette : learned;
        silhouette::extract_silhouette(
            mask, camera.intrinsics, silhouette_options, scratch, polygons);
        views::NamedView view{camera.name, {camera.intrinsics, camera.camera_from_site, {}, {}}};
        for (silhouette::SilhouettePolygon& polygon : polygons) {
            view.view.contours.push_back(std::move(polygon.vertices_px));
        }
        views.push_back(std::move(view));
    }
    return views;
}

}  // namespace atrium::hull_tool
