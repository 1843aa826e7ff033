#include "site_node/pipeline.hpp"

#include "core/base/resize_keeping.hpp"
#include "core/base/timestamp.hpp"
#include "site_node/remote_results.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <optional>

namespace atrium::site_node {
namespace {

using Clock = std::chrono::steady_clock;

}  // namespace

// State that one camera keeps between metaframes. One per camera allows parallel work.
struct Pipeline::CameraStage {
    // of the first stage
    std::optional<SilhouetteStage> silhouettes;  // empty: excluded, has no background
    // of the second stage
    TextureStage texture;
};

// Data of one camera in one metaframe.
struct Pipeline::Silhouettes::Camera : PictureSilhouette {
    bool sees_somebody = false;
    double texture_ms = 0.0;
    Expected<void> result;

    // Takes what a camera node found in the picture.
    void take(const capture::FoundSilhouette& found) {
        contours = found.contours_px;
        outlines.clear();
        dropped.clear();
        counts.num_not_undistorted = found.num_contours_dropped;
        view_shift_px = found.view_shift_px;
        segmentation_ms = found.segmentation_ms;
        polygons_ms = found.polygons_ms;
        texture_ms = found.texture_ms;
    }

    void begin() {
        counts = {};
        sees_somebody = false;
        segmentation_ms = polygons_ms = texture_ms = 0.0;
        result = {};
    }
};

Pipeline::Silhouettes::Silhouettes() = default;
Pipeline::Silhouettes::Silhouettes(Silhouettes&&) noexcept = default;
Pipeline::Silhouettes& Pipeline::Silhouettes::operator=(Silhouettes&&) noexcept = default;
Pipeline::Silhouettes::~Silhouettes() = default;

std::vector<std::vector<Eigen::Vector2d>> Pipeline::Silhouettes::delivered_outlines(
    std::size_t camera) const {
    if (delivered_[camera] == 0) return {};
    return kept_outlines(*cameras_[camera]);
}

Pipeline::Pipeline(std::vector<geometry::CalibratedCamera> cameras,
                   const PipelineOptions& options,
                   HullStage hull)
    : cameras_(std::move(cameras)),
      options_(options),
      hull_(std::move(hull)),
      meshes_(std::max<std::size_t>(1, hull_.regions().size()), options.mesh) {
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
    pipeline.camouflage_ = CamouflageStage::create(cameras, options.hull);
    if (source.has_silhouettes()) {
        for (std::size_t i = 0; i < cameras.size(); ++i)
            pipeline.stages_[i]->silhouettes.emplace(cameras[i], options);
        return pipeline;
    }
    if (!options.worker.socket.empty())
        pipeline.worker_ =
            std::make_shared<segmentation_worker::WorkerTally>(options.worker.deadline_ms);
    auto stages =
        make_silhouette_stages(source, all_cameras(source), options, stop, pipeline.worker_);
    for (std::size_t i = 0; i < stages.size(); ++i) {
        auto& stage = stages[i];
        if (!stage && stage.error().kind == ErrorKind::kUnavailable && !stop.stop_requested())
            continue;
        if (!stage) return tl::unexpected(stage.error());
        pipeline.stages_[i]->silhouettes = std::move(*stage);
    }
    return pipeline;
}

std::vector<std::string> Pipeline::cameras_without_background() const {
    std::vector<std::string> names;
    for (std::size_t i = 0; i < stages_.size(); ++i) {
        if (!stages_[i]->silhouettes) names.push_back(cameras_[i].name);
    }
    return names;
}

const segmentation::BackgroundStatistics* Pipeline::room(std::size_t camera) const {
    const auto& stage = stages_[camera]->silhouettes;
    return stage && stage->room().width > 0 ? &stage->room() : nullptr;
}

bool Pipeline::had_people() const {
    return std::ranges::any_of(stages_, [](const auto& stage) {
        return stage->silhouettes && stage->silhouettes->had_people();
    });
}

Expected<void> Pipeline::find_silhouettes(const capture::Metaframe& metaframe,
                                          Executor& executor,
                                          Silhouettes& out) {
    const auto begin = Clock::now();
    out.metaframe_ = metaframe;
    out.delivered_.assign(cameras_.size(), 0);
    while (out.cameras_.size() < cameras_.size())
        out.cameras_.push_back(std::make_unique<Silhouettes::Camera>());
    if (worker_ != nullptr) {
        // it gets the pictures of an instant together, and no worker of the executor waits for it
        const auto begin_camera = [&](std::size_t i, std::size_t worker) {
            const capture::CameraFrame& frame = out.metaframe_.frames[i];
            Silhouettes::Camera& camera = *out.cameras_[i];
            camera.begin();
            auto& stage = stages_[i]->silhouettes;
            if (frame.found != nullptr || frame.is_lost() || !stage) return;
            camera.result = stage->begin(frame, {&executor, worker}, camera);
        };
        executor.parallel_for(cameras_.size(), begin_camera);
        for (const auto& stage : stages_)
            if (stage->silhouettes) stage->silhouettes->await();
    }
    const auto work_on_camera = [&](std::size_t i, std::size_t worker) {
        const capture::CameraFrame& frame = out.metaframe_.frames[i];
        Silhouettes::Camera& camera = *out.cameras_[i];
        if (worker_ == nullptr) camera.begin();
        if (frame.found != nullptr) {
            out.delivered_[i] = 1;
            return camera.take(*frame.found);
        }
        auto& stage = stages_[i]->silhouettes;
        if (frame.is_lost() || !stage) return;
        out.delivered_[i] = 1;
        if (!camera.result) return;
        camera.result = stage->find(frame, {&executor, worker}, camera);
    };
    executor.parallel_for(cameras_.size(), work_on_camera);
    add_camouflaged(executor, out);
    out.milliseconds_ = milliseconds(Clock::now() - begin);
    for (const auto& frame : out.metaframe_.frames) {
        if (frame.found != nullptr)
            out.milliseconds_ = std::max(out.milliseconds_,
                                         frame.found->segmentation_ms + frame.found->polygons_ms);
    }
    return first_failure(out);
}

void Pipeline::add_camouflaged(Executor& executor, Silhouettes& out) {
    if (!camouflage_) return;
    camouflage_cameras_.assign(cameras_.size(), {});
    for (std::size_t i = 0; i < cameras_.size(); ++i) {
        const capture::CameraFrame& frame = out.metaframe_.frames[i];
        auto& stage = stages_[i]->silhouettes;
        if (out.delivered_[i] == 0 || !out.cameras_[i]->result || frame.found != nullptr ||
            frame.silhouette != nullptr || stage->asks_worker())
            continue;
        camouflage_cameras_[i] = {&*stage, out.cameras_[i].get()};
    }
    camouflage_->add(out.metaframe_, camouflage_cameras_, executor);
    out.camouflage_ms_ = camouflage_->milliseconds();
    out.num_camouflaged_px_ = camouflage_->num_pixels();
}

Expected<void> Pipeline::encode_texture(Silhouettes& silhouettes,
                                        const ColourCoding& coding,
                                        std::size_t camera,
                                        CodedCamera& coded) {
    Silhouettes::Camera& seen = *silhouettes.cameras_[camera];
    if (silhouettes.delivered_[camera] == 0 || hull_.contours(camera).empty()) return {};
    if (silhouettes.metaframe_.frames[camera].found != nullptr) return {};
    const auto begin = Clock::now();
    coded.camera = static_cast<std::uint32_t>(camera);
    const auto encoded = stages_[camera]->texture.encode(seen, options_.texture, coding, coded);
    if (!encoded) return tl::unexpected(encoded.error());
    seen.sees_somebody = *encoded;
    if (seen.sees_somebody) seen.texture_ms = milliseconds(Clock::now() - begin);
    return {};
}

// The mesh of region `index`, or the only one.
const geometry::TriangleMesh& Pipeline::mesh_of(const SiteFrame& frame, std::size_t index) const {
    return hull_.regions().empty() ? frame.hull.mesh : hull_.region_hulls()[index].mesh;
}

// Encodes the meshes and textures, each as one task.
Expected<void> Pipeline::encode(Silhouettes& silhouettes,
                                const ColourCoding& coding,
                                Executor& executor,
                                SiteFrame& frame) {
    resize_keeping(frame.cameras, cameras_.size(), spare_coded_);
    const std::size_t num_meshes = meshes_.num_meshes();
    const auto work = [&](std::size_t task, std::size_t) {
        if (task < num_meshes) return meshes_.encode(task, mesh_of(frame, task), cameras_);
        const std::size_t camera = task - num_meshes;
        silhouettes.cameras_[camera]->result =
            encode_texture(silhouettes, coding, camera, frame.cameras[camera]);
    };
    executor.parallel_for(num_meshes + cameras_.size(), work);
    frame.work_milliseconds.mesh = meshes_.milliseconds();
    if (auto coded = meshes_.result(); !coded) return coded;
    std::size_t num_kept = 0;
    for (std::size_t i = 0; i < cameras_.size(); ++i) {
        if (!silhouettes.cameras_[i]->sees_somebody) continue;
        if (num_kept != i) std::swap(frame.cameras[num_kept], frame.cameras[i]);
        ++num_kept;
    }
    resize_keeping(frame.cameras, num_kept, spare_coded_);
    return first_failure(silhouettes);
}

// Puts the meshes of all regions after each other, in the order of the regions.
void Pipeline::join_meshes(SiteFrame& frame) {
    if (hull_.regions().empty()) return frame.draco.swap(meshes_.draco(0));
    std::vector<std::span<const std::uint8_t>> meshes;
    for (std::size_t i = 0; i < meshes_.num_meshes(); ++i) meshes.push_back(meshes_.draco(i));
    for (const bus::RegionMeshes& remote : frame.remote) {
        std::span<const std::uint8_t> left(remote.draco);
        for (const bus::RegionHull& hull : remote.regions) {
            meshes[hull.region] = left.first(hull.num_bytes);
            left = left.subspan(hull.num_bytes);
        }
    }
    for (const auto& mesh : meshes) {
        if (mesh.empty()) continue;
        frame.draco.insert(frame.draco.end(), mesh.begin(), mesh.end());
        frame.mesh_sizes.push_back(static_cast<std::uint32_t>(mesh.size()));
    }
    if (frame.mesh_sizes.size() == 1) frame.mesh_sizes.clear();
}

Expected<void> Pipeline::first_failure(const Silhouettes& silhouettes) const {
    for (std::size_t i = 0; i < cameras_.size(); ++i) {
        if (const auto& result = silhouettes.cameras_[i]->result; !result) {
            return make_error(
                result.error().kind,
                fmt::format("camera '{}': {}", cameras_[i].name, result.error().message));
        }
    }
    return {};
}

// Collects counts and durations of the stages.
void Pipeline::sum_up(const Silhouettes& silhouettes, SiteFrame& frame) {
    const hull::VisualHull& hull = frame.hull;
    const auto& delivered = silhouettes.delivered_;
    frame.losses = {
        static_cast<std::uint32_t>(std::count(delivered.begin(), delivered.end(), std::uint8_t{0})),
        hull.num_phantoms_dropped,
        hull.num_fragments_dropped,
        kLitresPerM3 * hull.volume_dropped_m3,
        hull.num_contours_dropped,
        hull.num_contours_repaired,
        hull.num_regions_failed};
    for (const bus::RegionMeshes& remote : frame.remote) add(remote, frame);
    frame.work_milliseconds.segmentation = silhouettes.camouflage_ms_;
    frame.num_camouflaged_px = silhouettes.num_camouflaged_px_;
    for (std::size_t i = 0; i < silhouettes.cameras_.size(); ++i) {
        const auto& camera = silhouettes.cameras_[i];
        frame.losses.contours_dropped +=
            camera->counts.num_not_undistorted + camera->counts.num_not_simple;
        if (silhouettes.metaframe_.frames[i].found != nullptr) continue;  // work of a camera node
        frame.work_milliseconds.segmentation += camera->segmentation_ms;
        frame.work_milliseconds.polygons += camera->polygons_ms;
        frame.work_milliseconds.textures += camera->texture_ms;
    }
}

// What refines the hull; camera nodes keep their pictures.
std::span<const refine::PictureView> Pipeline::pictures_of(const Silhouettes& silhouettes) {
    pictures_.clear();
    if (!hull_.uses_pictures()) return pictures_;
    for (std::size_t i = 0; i < cameras_.size(); ++i) {
        refine::PictureView& view = pictures_.emplace_back();
        view.camera = &cameras_[i];
        const capture::CameraFrame& frame = silhouettes.metaframe_.frames[i];
        if (silhouettes.delivered_[i] == 0 || frame.found != nullptr || frame.is_lost()) continue;
        const Silhouettes::Camera& seen = *silhouettes.cameras_[i];
        view.picture = seen.picture;
        view.mask = &seen.mask.mask;
        view.subject = seen.subject;
    }
    return pictures_;
}

Expected<void> Pipeline::compute(Silhouettes& silhouettes,
                                 const ColourCoding& coding,
                                 Executor& executor,
                                 SiteFrame& frame) {
    const auto hull_begin = Clock::now();
    frame.frame_id = silhouettes.metaframe_.frame_id;
    frame.capture_time = silhouettes.metaframe_.capture_time;
    frame.draco.clear();
    frame.mesh_sizes.clear();
    frame.remote.clear();
    frame.remote_textures.clear();
    frame.work_milliseconds = {};
    meshes_.clear();
    for (std::size_t i = 0; i < cameras_.size(); ++i) {
        if (silhouettes.delivered_[i] != 0)
            hull_.contours(i).swap(silhouettes.cameras_[i]->contours);
    }
    if (remote_ != nullptr)
        remote_->order({frame.frame_id, frame.capture_time}, hull_.views(), silhouettes.delivered_);
    hull_.compute(silhouettes.delivered_, pictures_of(silhouettes), executor, frame.hull);

    const auto encode_begin = Clock::now();
    Expected<void> encoded;
    if (frame.hull.status == hull::HullStatus::kOk)
        encoded = encode(silhouettes, coding, executor, frame);
    else
        resize_keeping(frame.cameras, 0, spare_coded_);
    const auto wait_begin = Clock::now();
    if (remote_ != nullptr) frame.remote = remote_->collect();
    const auto wait_end = Clock::now();
    if (!encoded) return encoded;
    join_meshes(frame);
    if (auto failed = failure_without_mesh(frame, hull_.has_own()); !failed) return failed;
    if (!frame.draco.empty()) name_remote_textures(silhouettes.metaframe_, frame);
    sum_up(silhouettes, frame);
    frame.work_milliseconds.refinement = hull_.refinement_ms();
    frame.work_milliseconds.hull = milliseconds(encode_begin - hull_begin) - hull_.refinement_ms();
    frame.work_milliseconds.waiting = milliseconds(wait_end - wait_begin);
    const auto end = Clock::now();
    frame.milliseconds = {
        silhouettes.milliseconds_,
        milliseconds(encode_begin - hull_begin) + milliseconds(wait_end - wait_begin),
        milliseconds(wait_begin - encode_begin) + milliseconds(end - wait_end),
        silhouettes.milliseconds_ + milliseconds(end - hull_begin)};
    return {};
}

std::vector<views::NamedView> Pipeline::views(const Silhouettes& silhouettes) const {
    std::vector<views::NamedView> views;
    for (std::size_t i = 0; i < cameras_.size(); ++i) {
        if (silhouettes.delivered_[i] != 0) views.push_back({cameras_[i].name, hull_.views()[i]});
    }
    return views;
}

rig_check::Look Pipeline::look(const Silhouettes& silhouettes, const SiteFrame& frame) const {
    rig_check::Look look;
    look.views = views(silhouettes);
    for (std::size_t i = 0; i < cameras_.size(); ++i) {
        if (silhouettes.delivered_[i] == 0) continue;
        const auto& shift = silhouettes.cameras_[i]->view_shift_px;
        if (shift) {
            const double turn_rad = std::atan(shift->norm() / cameras_[i].intrinsics.fx);
            look.shifted.push_back({cameras_[i].name, shift->norm(), turn_rad});
        }
    }
    const auto describe = [&](const geometry::TriangleMesh& mesh) {
        if (mesh.empty()) return;
        look.hull_extent = geometry::bounds(mesh);
        look.hull_volume_m3 = geometry::volume_m3(mesh);
        look.footing = rig_check::find_footing(mesh);
    };
    look.is_hull_whole =
        std::ranges::all_of(frame.remote, &std::string::empty, &bus::RegionMeshes::reason);
    if (frame.remote.empty())
        describe(frame.hull.mesh);
    else if (look.is_hull_whole)
        describe(whole_mesh(frame));
    return look;
}

Expected<void> Pipeline::process(const capture::Metaframe& metaframe,
                                 Executor& executor,
                                 SiteFrame& frame) {
    if (auto found = find_silhouettes(metaframe, executor, own_silhouettes_); !found) return found;
    return compute(own_silhouettes_, {options_.jpeg_quality, 1}, executor, frame);
}

}  // namespace atrium::site_node
