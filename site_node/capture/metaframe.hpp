#pragma once

#include "core/base/timestamp.hpp"
#include "core/image/raw_image.hpp"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

namespace atrium::capture {

/// One picture of one camera, as it arrives.
struct CameraFrame {
    std::size_t camera = 0;  // index into the rig
    Timestamp
        capture_time;       // the camera's own, on the site's clock; what metaframes are matched by
    image::RawImage image;  // empty: the picture of this time is lost, and nobody needs to wait
    std::shared_ptr<const image::Mask> silhouette;  // null: to be segmented
};

/// The pictures of one trigger, one per camera of the rig. Those that are missing, if any, have no
/// image.
struct Metaframe {
    std::uint64_t frame_id = 0;       // grows with every trigger, those that were dropped included
    Timestamp capture_time;           // the earliest of its pictures
    std::vector<CameraFrame> frames;  // frames[i].camera == i
};

}  // namespace atrium::capture
