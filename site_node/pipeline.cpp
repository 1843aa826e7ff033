#include "site_node/pipeline.hpp"

#include "core/base/resize_keeping.hpp"

#include <fmt/format.h>

#include <chrono>

namespace atrium::site_node {
namespace {

using Clock = std::chrono::steady_clock;

double milliseconds_between(Clock::time_point begin, Clock::time_point end) {
    return std::chrono::duration<double, std::milli>(end - begin).count();
}

// Somebody is in the room only if every camera's cone and the hull say so; the other outcomes are
// answers too.
bool is_nobody(hull::HullStatus status) { return status == hull::HullStatus::kEmptyIntersection; }

}  // namespace

// Everything that one camera needs, so that cameras can be worked on in parallel.
struct Pipeline::CameraStage {
    image::YuvImage picture_buffer;  // what the camera does not deliver in the working form
    image::YuvView picture;          // of the metaframe that is being worked on
    segmentation::Segmenter segmenter;
    image::Mask mask;
    silhouette::SilhouetteScratch silhouette;
    std::vector<silhouette::SilhouettePolygon> polygons;
    silhouette::SilhouetteCounts counts;
    std::vector<std::vector<Eigen::Vector2d>> spare_contours;
    texture::TextureScratch texture;
    codec::TextureCrop crop;
    codec::TextureEncoder encoder;
    bool is_left_out = false;  // there is no background
    bool sees_somebody = false;
    double segmentation_ms = 0.0;
    double polygons_ms = 0.0;
    double texture_ms = 0.0;
    Expected<void> result;

    void begin() {
        counts = {};
        sees_somebody = false;
        segmentation_ms = polygons_ms = texture_ms = 0.0;
        result = {};
    }
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
    auto rooms = load_or_learn_backgrounds(source, options.background, options.segmentation, stop);
    for (std::size_t i = 0; i < pipeline.cameras_.size(); ++i) {
        auto& room = rooms[i];
        if (!room && room.error().kind == ErrorKind::kUnavailable && !stop.stop_requested()) {
            pipeline.stages_[i]->is_left_out = true;
            continue;
        }
        if (!room) return tl::unexpected(room.error());
        pipeline.stages_[i]->segmenter =
            segmentation::Segmenter(std::move(*room),
                                    options.segmentation,
                                    areas_of(options.areas, pipeline.cameras_[i].name));
    }
    return pipeline;
}

std::vector<std::string> Pipeline::cameras_without_background() const {
    std::vector<std::string> names;
    for (std::size_t i = 0; i < stages_.size(); ++i) {
        if (stages_[i]->is_left_out) names.push_back(cameras_[i].name);
    }
    return names;
}

Expected<void> Pipeline::find_silhouette(const capture::CameraFrame& frame, CameraStage& stage) {
    const geometry::CalibratedCamera& camera = cameras_[frame.camera];
    const auto begin = Clock::now();
    image::WorkingPicture picture(frame.image, stage.picture_buffer);
    stage.picture = picture.view();
    if (frame.silhouette != nullptr) {
        picture.make_all();
        stage.mask = *frame.silhouette;
    } else {
        auto segmented = stage.segmenter.segment(picture, stage.mask);
        if (!segmented) return segmented;
    }
    const auto segmented_at = Clock::now();
    stage.counts = silhouette::extract_silhouette(
        stage.mask, camera.intrinsics, options_.silhouette, stage.silhouette, stage.polygons);

    auto& contours = hull_.contours(frame.camera);
    resize_keeping(contours, stage.polygons.size(), stage.spare_contours);
    for (std::size_t p = 0; p < stage.polygons.size(); ++p)
        contours[p] = stage.polygons[p].vertices_px;
    stage.segmentation_ms = milliseconds_between(begin, segmented_at);
    stage.polygons_ms = milliseconds_between(segmented_at, Clock::now());
    return {};
}

Expected<void> Pipeline::find_silhouettes(const capture::Metaframe& metaframe, Executor& executor) {
    const auto work_on_camera = [&](std::size_t i, std::size_t) {
        CameraStage& stage = *stages_[i];
        stage.begin();
        delivered_[i] = metaframe.frames[i].image.empty() || stage.is_left_out ? 0 : 1;
        if (delivered_[i] != 0) stage.result = find_silhouette(metaframe.frames[i], stage);
    };
    executor.parallel_for(cameras_.size(), work_on_camera);
    return first_failure();
}

Expected<void> Pipeline::encode_texture(std::size_t camera, CodedCamera& coded) {
    CameraStage& stage = *stages_[camera];
    if (delivered_[camera] == 0 || stage.polygons.empty()) return {};
    const auto begin = Clock::now();
    stage.sees_somebody =
        texture::crop_texture(stage.picture,
                              stage.mask,
                              silhouette::bounding_rect(stage.silhouette.contours),
                              options_.texture,
                              stage.texture,
                              stage.crop);
    if (!stage.sees_somebody) return {};
    coded.camera = static_cast<std::uint32_t>(camera);
    coded.crop_px = stage.crop.crop_px;
    auto encoded =
        stage.encoder.encode(stage.crop, coding_.jpeg_quality, coding_.divisor, coded.texture);
    stage.texture_ms = milliseconds_between(begin, Clock::now());
    return encoded;
}

// The mesh, which is one task, beside the textures.
Expected<void> Pipeline::encode(Executor& executor, SiteFrame& frame) {
    resize_keeping(frame.cameras, cameras_.size(), spare_coded_);
    Expected<std::size_t> mesh;
    const auto work = [&](std::size_t task, std::size_t) {
        if (task > 0) {
            stages_[task - 1]->result = encode_texture(task - 1, frame.cameras[task - 1]);
            return;
        }
        const auto begin = Clock::now();
        codec::MeshCodecOptions options = options_.mesh;
        if (options.position_bits == 0)
            options.position_bits = codec::position_bits_for(frame.hull.mesh, cameras_);
        mesh = mesh_encoder_.encode(frame.hull.mesh, options, frame.draco);
        frame.work_milliseconds.mesh = milliseconds_between(begin, Clock::now());
    };
    executor.parallel_for(1 + cameras_.size(), work);
    if (!mesh) return tl::unexpected(mesh.error());
    std::size_t num_kept = 0;
    for (std::size_t i = 0; i < cameras_.size(); ++i) {
        if (!stages_[i]->sees_somebody) continue;
        if (num_kept != i) std::swap(frame.cameras[num_kept], frame.cameras[i]);
        ++num_kept;
    }
    resize_keeping(frame.cameras, num_kept, spare_coded_);
    return first_failure();
}

Expected<void> Pipeline::first_failure() const {
    for (std::size_t i = 0; i < cameras_.size(); ++i) {
        if (const auto& result = stages_[i]->result; !result) {
            return make_error(
                result.error().kind,
                fmt::format("camera '{}': {}", cameras_[i].name, result.error().message));
        }
    }
    return {};
}

// What the stages counted and measured.
void Pipeline::sum_up(SiteFrame& frame) const {
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
        frame.work_milliseconds.segmentation += stage->segmentation_ms;
        frame.work_milliseconds.polygons += stage->polygons_ms;
        frame.work_milliseconds.textures += stage->texture_ms;
    }
}

Expected<void> Pipeline::process(const capture::Metaframe& metaframe,
                                 Executor& executor,
                                 SiteFrame& frame) {
    return process(metaframe, {options_.jpeg_quality, 1}, executor, frame);
}

Expected<void> Pipeline::process(const capture::Metaframe& metaframe,
                                 const ColourCoding& coding,
                                 Executor& executor,
                                 SiteFrame& frame) {
    coding_ = coding;
    const auto begin = Clock::now();
    frame.frame_id = metaframe.frame_id;
    frame.capture_time = metaframe.capture_time;
    frame.draco.clear();
    frame.work_milliseconds = {};
    if (auto done = find_silhouettes(metaframe, executor); !done) return done;

    const auto hull_begin = Clock::now();
    hull_.compute(delivered_, executor, frame.hull);

    const auto encode_begin = Clock::now();
    if (frame.hull.status == hull::HullStatus::kOk) {
        if (auto encoded = encode(executor, frame); !encoded) return encoded;
    } else if (is_nobody(frame.hull.status)) {
        resize_keeping(frame.cameras, 0, spare_coded_);
    } else {
        return make_error(ErrorKind::kInvalidData,
                          fmt::format("no hull: {}", hull::to_string(frame.hull.status)));
    }
    sum_up(frame);
    const auto end = Clock::now();
    frame.milliseconds = {milliseconds_between(begin, hull_begin),
                          milliseconds_between(hull_begin, encode_begin),
                          milliseconds_between(encode_begin, end),
                          milliseconds_between(begin, end)};
    return {};
}

std::vector<std::vector<Eigen::Vector2d>> Pipeline::delivered_outlines(std::size_t camera) const {
    const silhouette::SilhouetteScratch& scratch = stages_[camera]->silhouette;
    std::vector<std::vector<Eigen::Vector2d>> outlines;
    for (std::size_t c = 0; c < scratch.dropped.size(); ++c) {
        if (scratch.dropped[c] == 0) outlines.push_back(scratch.outlines[c].vertices_px);
    }
    return outlines;
}

}  // namespace atrium::site_node
