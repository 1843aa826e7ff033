#pragma once

#include "core/base/timestamp.hpp"
#include "core/image/raw_image.hpp"

#include <Eigen/Core>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

namespace atrium::capture {

/// What a camera node found in its picture: it comes instead of the picture.
struct FoundSilhouette {
    std::vector<std::vector<Eigen::Vector2d>> contours_px;  // undistorted, as SilhouetteStage's
    bool has_texture = false;            // the camera node publishes one of this picture
    std::uint64_t texture_frame_id = 0;  // which names that texture
    Timestamp texture_time;              // on the camera node's clock
    std::optional<Eigen::Vector2d> view_shift_px;
    std::uint32_t num_contours_dropped = 0;
    double segmentation_ms = 0.0;
    double polygons_ms = 0.0;
    double texture_ms = 0.0;  // of the camera's previous texture, as are the bytes
    std::uint32_t colour_bytes = 0;
    std::uint32_t mask_bytes = 0;
};

/// One picture of one camera.
struct CameraFrame {
    std::size_t camera = 0;  // index into the rig
    Timestamp capture_time;  // time of exposure on the site clock; metaframes are matched by it
    image::RawImage image;   // empty: see `is_lost`
    std::shared_ptr<const image::Mask> silhouette;   // null: needs segmentation
    std::shared_ptr<const FoundSilhouette> found{};  // instead of `image`; null: there is none

    bool is_lost() const { return image.empty() && found == nullptr; }
};

/// The pictures of one trigger, one per camera of the rig. A missing picture is lost.
struct Metaframe {
    std::uint64_t frame_id = 0;       // grows with every trigger, also with dropped ones
    Timestamp capture_time;           // the earliest of its pictures
    std::vector<CameraFrame> frames;  // frames[i].camera == i
};

}  // namespace atrium::capture
