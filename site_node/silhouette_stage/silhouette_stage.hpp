#pragma once

#include "core/base/executor.hpp"
#include "core/base/expected.hpp"
#include "core/geometry/pinhole_camera.hpp"
#include "core/image/image.hpp"
#include "core/image/sparse_mask.hpp"
#include "site_node/capture/frame_source.hpp"
#include "site_node/segmentation/room_watch.hpp"
#include "site_node/segmentation/segmentation.hpp"
#include "site_node/segmentation_worker/worker_client.hpp"
#include "site_node/silhouette/silhouette.hpp"
#include "site_node/silhouette_stage/silhouette_stage_options.hpp"

#include <Eigen/Core>

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <stop_token>
#include <string>
#include <vector>

namespace atrium::site_node {

/// The silhouette in one picture. Reusable: keeps its memory.
struct PictureSilhouette {
    image::YuvImage picture_buffer;  // for pictures that need conversion to the working form
    image::YuvView picture;          // working form; valid as long as the frame
    image::SparseMask mask;
    std::vector<std::vector<Eigen::Vector2d>> contours;  // undistorted [px]
    image::PixelRect subject;                   // bounds of all contours, delivered picture
    std::vector<silhouette::Outline> outlines;  // delivered picture
    std::vector<std::uint8_t> dropped;          // per outline
    silhouette::SilhouetteCounts counts;
    /// By how much the picture shows the learned room shifted: the camera was moved since.
    std::optional<Eigen::Vector2d> view_shift_px;
    double segmentation_ms = 0.0;
    double polygons_ms = 0.0;
};

/// The outlines that became contours, in the delivered picture [px].
std::vector<std::vector<Eigen::Vector2d>> kept_outlines(const PictureSilhouette& silhouette);

/// Finds the silhouettes in successive pictures of one camera: picture, mask, contours. Not
/// thread-safe; cameras are independent.
class SilhouetteStage {
public:
    /// Without `segmenter` it finds people only in frames that carry a silhouette.
    SilhouetteStage(const geometry::CalibratedCamera& camera,
                    const SilhouetteStageOptions& options,
                    segmentation::Segmenter segmenter = {});

    /// From now on asks a worker for the people in each picture. Pictures without its answer keep
    /// the mask of the segmenter, which goes on with every picture.
    void ask(std::unique_ptr<segmentation_worker::WorkerClient> worker) {
        worker_ = std::move(worker);
    }

    /// Begins with a picture: its mask, unless the worker answers. `find` with the same frame and
    /// `out` ends it; alone it does both. In between the worker works. Errors as `find`.
    Expected<void> begin(const capture::CameraFrame& frame,
                         const GiveWay& give_way,
                         PictureSilhouette& out);
    /// Waits for the worker's answer to the picture that was begun, until its time limit; `find`
    /// then does not wait.
    void await() {
        if (worker_ != nullptr) worker_->await();
    }

    /// Uses the frame's silhouette if it carries one, else segments its picture. Pictures must come
    /// in time order. Some of them serve to check the learned room (RoomWatch): if it seems to
    /// contain a person, this logs a warning, once. Gives way after each 16 rows. Allocates only
    /// while `out` and scratch memory grow.
    Expected<void> find(const capture::CameraFrame& frame,
                        const GiveWay& give_way,
                        PictureSilhouette& out);

    /// Adds squares to what `find` found in this frame, where the camera looks, and finds the
    /// contours again. Returns the number of pixels.
    std::uint64_t add(const capture::CameraFrame& frame,
                      std::span<const image::PixelRect> squares,
                      const GiveWay& give_way,
                      PictureSilhouette& out);

    const std::string& camera() const { return name_; }
    const segmentation::Segmenter& segmenter() const { return segmenter_; }
    /// Whether a worker, instead of the segmenter, says where people are.
    bool asks_worker() const { return worker_ != nullptr; }
    /// The empty room as it was learned; without pixels if there is none.
    const segmentation::BackgroundStatistics& room() const { return segmenter_.model().room; }
    /// Whether the room was learned from pictures with people in it.
    bool had_people() const { return segmenter_.model().room.had_people; }

private:
    void watch_room(const PictureSilhouette& found);
    void find_contours(PictureSilhouette& out);
    void offer(const capture::CameraFrame& frame,
               const GiveWay& give_way,
               image::WorkingPicture& picture);

    geometry::PinholeCamera intrinsics_;
    silhouette::SilhouetteOptions options_;
    std::string name_;
    segmentation::Segmenter segmenter_;
    segmentation::RoomWatch watch_;
    std::unique_ptr<segmentation_worker::WorkerClient> worker_;  // null: none
    bool is_begun_ = false;
    silhouette::SilhouetteScratch scratch_;
    std::vector<silhouette::SilhouettePolygon> polygons_;
    std::vector<std::vector<Eigen::Vector2d>> spare_contours_;
};

/// Makes the stage of each of `cameras`, with its loaded or learned background, and with its worker
/// if the options name one; `tally`, or one of their own, counts its answers. Errors as in
/// load_or_learn_backgrounds.
std::vector<Expected<SilhouetteStage>> make_silhouette_stages(
    capture::FrameSource& source,
    const std::vector<std::size_t>& cameras,
    const SilhouetteStageOptions& options,
    std::stop_token stop,
    std::shared_ptr<segmentation_worker::WorkerTally> tally = nullptr);

/// Returns the indices of all cameras of `source`.
std::vector<std::size_t> all_cameras(const capture::FrameSource& source);

}  // namespace atrium::site_node
