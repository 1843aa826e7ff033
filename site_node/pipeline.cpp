#include "site_node/pipeline.hpp"

#include <fmt/format.h>

#include <chrono>

namespace atrium::site_node {
namespace {

double milliseconds_since(std::chrono::steady_clock::time_point begin) {
    return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin)
        .count();
}

// Somebody is in the room only if every camera's cone and the hull say so; the other outcomes are
// answers too.
bool is_nobody(hull::HullStatus status) { return status == hull::HullStatus::kEmptyIntersection; }

}  // namespace

// Everything that one camera needs, so that cameras can be worked on in parallel.
struct Pipeline::CameraStage {
    image::YuvImage picture;  // what the camera does not deliver in the working form
    segmentation::Segmenter segmenter;
    image::Mask mask;
    silhouette::SilhouetteScratch silhouette;
    std::vector<silhouette::SilhouettePolygon> polygons;
    silhouette::SilhouetteCounts counts;
    texture::TextureScratch texture;
    codec::TextureCrop crop;
    codec::TextureEncoder encoder;
    bool sees_somebody = false;
    Expected<void> result;
};

Pipeline::Pipeline(std::vector<geometry::CalibratedCamera> cameras,
                   const PipelineOptions& options,
                   HullStage hull)
    : cameras_(std::move(cameras)),
      options_(options),
      delivered_(cameras_.size(), 0),
      hull_(std::move(hull)) {
    for (std::size_t i = 0; i < cameras_.size(); ++i)
        stages_.push_back(std::make_unique<CameraStage>());
}

Pipeline::Pipeline(Pipeline&&) noexcept = default;
Pipeline& Pipeline::operator=(Pipeline&&) noexcept = default;
Pipeline::~Pipeline() = default;

Expected<Pipeline> Pipeline::create(capture::FrameSource& source,
                                    const PipelineOptions& options,
                                    std::stop_token stop) {
    const auto& cameras = source.rig().cameras;
    auto hull = HullStage::create(cameras, options.hull, options.silhouette.tolerance_px);
    if (!hull) return tl::unexpected(hull.error());
    Pipeline pipeline(cameras, options, std::move(*hull));
    if (source.has_silhouettes()) return pipeline;
    for (std::size_t i = 0; i < pipeline.cameras_.size(); ++i) {
        auto room =
            load_or_learn_background(source, i, options.background, options.segmentation, stop);
        if (!room) return tl::unexpected(room.error());
        pipeline.stages_[i]->segmenter =
            segmentation::Segmenter(std::move(*room),
                                    options.segmentation,
                                    areas_of(options.areas, pipeline.cameras_[i].name));
    }
    return pipeline;
}

Expected<void> Pipeline::process_camera(const capture::CameraFrame& frame,
                                        CameraStage& stage,
                                        CodedCamera& coded) {
    const geometry::CalibratedCamera& camera = cameras_[frame.camera];
    const image::YuvView picture = image::working_view(frame.image, stage.picture);
    if (frame.silhouette != nullptr) {
        stage.mask = *frame.silhouette;
    } else {
        auto segmented = stage.segmenter.segment(picture, stage.mask);
        if (!segmented) return segmented;
    }
    stage.counts = silhouette::extract_silhouette(
        stage.mask, camera.intrinsics, options_.silhouette, stage.silhouette, stage.polygons);

    auto& contours = hull_.contours(frame.camera);
    contours.resize(stage.polygons.size());
    for (std::size_t p = 0; p < stage.polygons.size(); ++p)
        contours[p] = stage.polygons[p].vertices_px;

    stage.sees_somebody =
        !stage.polygons.empty() &&
        texture::crop_texture(picture, stage.mask, options_.texture, stage.texture, stage.crop);
    if (!stage.sees_somebody) return {};
    coded.camera = static_cast<std::uint32_t>(frame.camera);
    coded.crop_px = stage.crop.crop_px;
    return stage.encoder.encode(stage.crop, options_.jpeg_quality, coded.texture);
}

Expected<void> Pipeline::process_cameras(const capture::Metaframe& metaframe,
                                         Executor& executor,
                                         SiteFrame& frame) {
    const auto work_on_camera = [&](std::size_t i, std::size_t) {
        CameraStage& stage = *stages_[i];
        stage.result = {};
        stage.counts = {};
        stage.sees_somebody = false;
        delivered_[i] = metaframe.frames[i].image.empty() ? 0 : 1;
        if (delivered_[i] == 0) return;
        stage.result = process_camera(metaframe.frames[i], stage, frame.cameras[i]);
    };
    executor.parallel_for(cameras_.size(), work_on_camera);
    for (std::size_t i = 0; i < cameras_.size(); ++i) {
        if (const auto& result = stages_[i]->result; !result) {
            return make_error(
                result.error().kind,
                fmt::format("camera '{}': {}", cameras_[i].name, result.error().message));
        }
    }
    return {};
}

void Pipeline::count_left_out(SiteFrame& frame) const {
    const hull::VisualHull& hull = frame.hull;
    frame.left_out = {static_cast<std::uint32_t>(
                          std::count(delivered_.begin(), delivered_.end(), std::uint8_t{0})),
                      hull.num_phantoms_dropped,
                      hull.num_fragments_dropped,
                      kLitresPerM3 * hull.volume_dropped_m3,
                      hull.num_contours_dropped,
                      hull.num_contours_repaired,
                      hull.num_regions_failed};
    for (const auto& stage : stages_) {
        frame.left_out.contours_dropped +=
            stage->counts.num_not_undistorted + stage->counts.num_not_simple;
    }
}

Expected<void> Pipeline::process(const capture::Metaframe& metaframe,
                                 Executor& executor,
                                 SiteFrame& frame) {
    const auto begin = std::chrono::steady_clock::now();
    frame.frame_id = metaframe.frame_id;
    frame.capture_time = metaframe.capture_time;
    frame.cameras.resize(cameras_.size());
    frame.draco.clear();
    if (auto done = process_cameras(metaframe, executor, frame); !done) return done;
    frame.milliseconds.silhouettes = milliseconds_since(begin);

    const auto hull_begin = std::chrono::steady_clock::now();
    hull_.compute(delivered_, executor, frame.hull);
    count_left_out(frame);
    frame.milliseconds.hull = milliseconds_since(hull_begin);

    const auto encode_begin = std::chrono::steady_clock::now();
    if (frame.hull.status == hull::HullStatus::kOk) {
        if (auto coded = codec::encode_mesh(frame.hull.mesh, options_.mesh, frame.draco); !coded) {
            return tl::unexpected(coded.error());
        }
        std::size_t num_kept = 0;
        for (std::size_t i = 0; i < cameras_.size(); ++i) {
            if (!stages_[i]->sees_somebody) continue;
            if (num_kept != i) std::swap(frame.cameras[num_kept], frame.cameras[i]);
            ++num_kept;
        }
        frame.cameras.resize(num_kept);
    } else if (is_nobody(frame.hull.status)) {
        frame.cameras.clear();
    } else {
        return make_error(ErrorKind::kInvalidData,
                          fmt::format("no hull: {}", hull::to_string(frame.hull.status)));
    }
    frame.milliseconds.encode = milliseconds_since(encode_begin);
    frame.milliseconds.total = milliseconds_since(begin);
    return {};
}

}  // namespace atrium::site_node
