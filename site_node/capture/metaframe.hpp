#pragma once

#include "core/base/timestamp.hpp"
#include "core/image/raw_image.hpp"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

namespace atrium::capture {

/// One picture of one camera.
struct CameraFrame {
    std::size_t camera = 0;  // index into the rig
    Timestamp capture_time;  // time of exposure on the site clock; metaframes are matched by it
    image::RawImage image;   // empty: the picture of this time is lost
    std::shared_ptr<const image::Mask> silhouette;  // null: needs segmentation
};

/// The pictures of one trigger, one per camera of the rig. A missing picture has no image.
struct Metaframe {
    std::uint64_t frame_id = 0;       // grows with every trigger, also with dropped ones
    Timestamp capture_time;           // the earliest of its pictures
    std::vector<CameraFrame> frames;  // frames[i].camera == i
};

}  // namespace atrium::capture
