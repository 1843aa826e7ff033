#include "site_node/silhouette_stage/silhouette_stage.hpp"

#include "core/app/log.hpp"
#include "core/base/resize_keeping.hpp"
#include "core/image/raw_image.hpp"

#include <algorithm>
#include <chrono>
#include <functional>
#include <numeric>
#include <utility>

namespace atrium::site_node {
namespace {

using Clock = std::chrono::steady_clock;
using Milliseconds = std::chrono::duration<double, std::milli>;

}  // namespace

std::vector<std::vector<Eigen::Vector2d>> kept_outlines(const PictureSilhouette& silhouette) {
    std::vector<std::vector<Eigen::Vector2d>> outlines;
    for (std::size_t i = 0; i < silhouette.dropped.size(); ++i) {
        if (silhouette.dropped[i] == 0) outlines.push_back(silhouette.outlines[i].vertices_px);
    }
    return outlines;
}

SilhouetteStage::SilhouetteStage(const geometry::CalibratedCamera& camera,
                                 const SilhouetteStageOptions& options,
                                 segmentation::Segmenter segmenter)
    : intrinsics_(camera.intrinsics),
      options_(options.silhouette),
      name_(camera.name),
      segmenter_(std::move(segmenter)),
      watch_(static_cast<std::uint32_t>(std::hash<std::string>{}(camera.name) %
                                        segmentation::RoomWatch::kFirstGap)) {}

// Gives the picture to the worker if it takes one now; `picture` is then converted as a whole.
void SilhouetteStage::offer(const capture::CameraFrame& frame,
                            const GiveWay& give_way,
                            image::WorkingPicture& picture) {
    const image::YuvView& view = picture.view();
    const segmentation::BackgroundStatistics& room = segmenter_.model().room;
    if (view.width() != room.width || view.height() != room.height || view.mosaic != room.mosaic)
        return;  // the segmenter says so
    if (!worker_->wants_picture()) return;
    picture.make_all();
    picture = image::WorkingPicture(picture.view());
    worker_->offer(frame.image, picture.view(), frame.capture_time, segmenter_.model(), give_way);
}

Expected<void> SilhouetteStage::begin(const capture::CameraFrame& frame,
                                      const GiveWay& give_way,
                                      PictureSilhouette& out) {
    const auto begin = Clock::now();
    image::WorkingPicture picture(frame.image, out.picture_buffer);
    out.picture = picture.view();
    if (frame.silhouette != nullptr) {
        picture.make_all();
        out.mask.mask = *frame.silhouette;
        out.mask.forget();
    } else {
        if (worker_ != nullptr) offer(frame, give_way, picture);
        if (auto segmented = segmenter_.segment(picture, out.mask, give_way); !segmented)
            return segmented;
        if (watch_.is_due()) watch_room(out);
        if (watch_.is_view_due()) watch_.look_at_view(out.picture, segmenter_.model().room.luma);
    }
    out.view_shift_px = watch_.view_shift();
    out.segmentation_ms = Milliseconds(Clock::now() - begin).count();
    is_begun_ = true;
    return {};
}

Expected<void> SilhouetteStage::find(const capture::CameraFrame& frame,
                                     const GiveWay& give_way,
                                     PictureSilhouette& out) {
    if (!std::exchange(is_begun_, false)) {
        if (auto begun = begin(frame, give_way, out); !begun) return begun;
        is_begun_ = false;
    }
    const auto begun_at = Clock::now();
    if (worker_ != nullptr && frame.silhouette == nullptr) {
        worker_->take(give_way, out.mask);
        worker_->keep_last(out.mask.mask);
    }
    give_way();
    const auto segmented_at = Clock::now();
    find_contours(out);
    out.segmentation_ms += Milliseconds(segmented_at - begun_at).count();
    out.polygons_ms = Milliseconds(Clock::now() - segmented_at).count();
    return {};
}

void SilhouetteStage::find_contours(PictureSilhouette& out) {
    out.counts = silhouette::extract_silhouette(
        out.mask.mask, intrinsics_, options_, scratch_, polygons_, out.mask.rows);
    resize_keeping(out.contours, polygons_.size(), spare_contours_);
    for (std::size_t p = 0; p < polygons_.size(); ++p) out.contours[p] = polygons_[p].vertices_px;
    out.subject = silhouette::bounding_rect(scratch_.contours);
    out.outlines.swap(scratch_.outlines);
    out.dropped.swap(scratch_.dropped);
}

std::uint64_t SilhouetteStage::add(const capture::CameraFrame& frame,
                                   std::span<const image::PixelRect> squares,
                                   const GiveWay& give_way,
                                   PictureSilhouette& out) {
    constexpr int kMargin = 16;  // around people, pictures are valid so far
    std::uint64_t num_added = 0;
    int left = out.mask.mask.width;
    int top = out.mask.mask.height;
    int right = 0;
    int bottom = 0;
    for (const image::PixelRect& square : squares) {
        for (int y = square.y; y < square.y + square.height; ++y) {
            std::uint8_t* row = out.mask.mask.row(y);
            image::PixelSpan& span = out.mask.rows[static_cast<std::size_t>(y)];
            for (int x = square.x; x < square.x + square.width; ++x) {
                if (row[x] != 0 || !segmenter_.watches(x, y)) continue;
                row[x] = 255;
                ++num_added;
                span = span.begin == span.end
                           ? image::PixelSpan{x, x + 1}
                           : image::PixelSpan{std::min(span.begin, x), std::max(span.end, x + 1)};
            }
        }
        left = std::min(left, square.x);
        top = std::min(top, square.y);
        right = std::max(right, square.x + square.width);
        bottom = std::max(bottom, square.y + square.height);
    }
    if (num_added == 0) return 0;
    left = std::max(left - kMargin, 0) & ~1;
    top = std::max(top - kMargin, 0) & ~1;
    right = std::min(right + kMargin, out.picture.width()) & ~1;
    bottom = std::min(bottom + kMargin, out.picture.height()) & ~1;
    image::WorkingPicture picture(frame.image, out.picture_buffer);
    picture.make({left, top, right - left, bottom - top});
    give_way();
    find_contours(out);
    return num_added;
}

void SilhouetteStage::watch_room(const PictureSilhouette& found) {
    if (const auto light = watch_.look_at_light(found.picture, segmenter_.model().luma)) {
        app::log::warn(
            "camera '{}': the learned empty room {}: people cannot be told from it reliably; film "
            "it again with the camera, the light and the exposure of now, or learn it from people: "
            "--learn-background --segmentation.background_from people (docs/backgrounds.md)",
            name_,
            *light);
    }
    const auto ghost = watch_.look(found.picture, segmenter_.model().room, found.mask.mask);
    if (!ghost) return;
    app::log::warn(
        "camera '{}': the background seems to contain a person, or a thing that has gone, at "
        "({}, {}): learn it again with an empty room, or with --learn-background "
        "--segmentation.background_from people (docs/backgrounds.md)",
        name_,
        ghost->x,
        ghost->y);
}

namespace {

// Gives each stage its client. Waits a while for workers, which may have a network to load.
void ask_workers(std::vector<Expected<SilhouetteStage>>& stages,
                 const SilhouetteStageOptions& options,
                 const std::shared_ptr<segmentation_worker::WorkerTally>& tally,
                 const std::stop_token& stop) {
    constexpr std::chrono::seconds kPatience{10};
    std::vector<segmentation_worker::WorkerClient*> clients;
    for (Expected<SilhouetteStage>& stage : stages) {
        if (!stage) continue;
        auto client =
            segmentation_worker::WorkerClient::create(options.worker,
                                                      {stage->camera(),
                                                       stage->room().width,
                                                       stage->room().height,
                                                       areas_of(options.areas, stage->camera())},
                                                      options.segmentation,
                                                      tally);
        if (!client) {
            stage = tl::unexpected(client.error());
            continue;
        }
        clients.push_back(client->get());
        stage->ask(std::move(*client));
    }
    segmentation_worker::connect_at_start(clients, kPatience, stop);
}

}  // namespace

std::vector<Expected<SilhouetteStage>> make_silhouette_stages(
    capture::FrameSource& source,
    const std::vector<std::size_t>& cameras,
    const SilhouetteStageOptions& options,
    std::stop_token stop,
    std::shared_ptr<segmentation_worker::WorkerTally> tally) {
    std::vector<Expected<SilhouetteStage>> stages;
    stages.reserve(cameras.size());
    if (auto fits = segmentation_worker::check(options.worker); !fits) {
        while (stages.size() < cameras.size()) stages.emplace_back(tl::unexpected(fits.error()));
        return stages;
    }
    auto rooms =
        load_or_learn_backgrounds(source, cameras, options.background, options.segmentation, stop);
    for (std::size_t i = 0; i < cameras.size(); ++i) {
        const geometry::CalibratedCamera& camera = source.rig().cameras[cameras[i]];
        stages.push_back(rooms[i].map([&](segmentation::BackgroundStatistics& room) {
            return SilhouetteStage(
                camera,
                options,
                segmentation::Segmenter(
                    std::move(room), options.segmentation, areas_of(options.areas, camera.name)));
        }));
    }
    if (!options.worker.socket.empty()) {
        if (tally == nullptr)
            tally = std::make_shared<segmentation_worker::WorkerTally>(options.worker.deadline_ms);
        ask_workers(stages, options, tally, stop);
    }
    return stages;
}

std::vector<std::size_t> all_cameras(const capture::FrameSource& source) {
    std::vector<std::size_t> all(source.rig().cameras.size());
    std::iota(all.begin(), all.end(), 0);
    return all;
}

}  // namespace atrium::site_node
