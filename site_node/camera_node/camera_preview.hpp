#pragma once

#include "site_node/capture/metaframe.hpp"
#include "site_node/preview/preview.hpp"
#include "site_node/silhouette_stage/silhouette_stage.hpp"

#include <filesystem>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

namespace atrium::camera_node {

/// Shows what the cameras of this host see, each with its silhouette. Their pictures come one by
/// one: the next one of each camera makes one view of all. Holds a picture for a period at most, as
/// its memory may be a camera's. Thread-safe.
class CameraPreview {
public:
    /// `target` as in preview::Preview.
    CameraPreview(std::filesystem::path target, std::vector<std::string> camera_names);

    /// Takes a picture and what was found in it; of a lost picture `seen` is ignored.
    void take(std::size_t camera,
              const capture::CameraFrame& frame,
              const site_node::PictureSilhouette& seen);

private:
    void show();

    std::mutex mutex_;  // guards the members below
    preview::Preview preview_;
    std::vector<std::optional<capture::CameraFrame>> frames_;  // of the view that comes next
    std::vector<std::vector<std::vector<Eigen::Vector2d>>> outlines_px_;
};

}  // namespace atrium::camera_node
