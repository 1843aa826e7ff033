#include "site_node/camera_node/camera_preview.hpp"

#include <algorithm>
#include <utility>

namespace atrium::camera_node {

CameraPreview::CameraPreview(std::filesystem::path target, std::vector<std::string> camera_names)
    : preview_(std::move(target), camera_names),
      frames_(camera_names.size()),
      outlines_px_(camera_names.size()) {}

void CameraPreview::take(std::size_t camera,
                         const capture::CameraFrame& frame,
                         const site_node::PictureSilhouette& seen) {
    const std::lock_guard lock(mutex_);
    capture::Metaframe one;
    one.frames.push_back(frame);
    one.frames.back().camera = camera;
    if (!preview_.count(one)) return;
    // its second picture: some other camera sends none
    if (frames_[camera]) return show();
    outlines_px_[camera] =
        frame.image.empty() ? decltype(seen.contours){} : site_node::kept_outlines(seen);
    frames_[camera] = std::move(one.frames.back());
    if (std::ranges::all_of(frames_, [](const auto& each) { return each.has_value(); })) show();
}

void CameraPreview::show() {
    capture::Metaframe all;
    for (std::size_t camera = 0; camera < frames_.size(); ++camera) {
        capture::CameraFrame& frame = all.frames.emplace_back(
            std::exchange(frames_[camera], {}).value_or(capture::CameraFrame{}));
        frame.camera = camera;
    }
    preview_.show(all, std::exchange(outlines_px_, decltype(outlines_px_)(frames_.size())));
}

}  // namespace atrium::camera_node
