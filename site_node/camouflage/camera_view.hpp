#pragma once

#include "core/image/image.hpp"
#include "site_node/camouflage/camera_eye.hpp"
#include "site_node/segmentation/background_model.hpp"

#include <Eigen/Core>

namespace atrium::camouflage {

/// What a camera shows of people at one instant.
struct CameraView {
    image::YuvView picture;  // empty: the camera does not count. Rows 4n and 4n + 1 are valid
    const image::Mask* mask = nullptr;
    image::PixelRect subject;                             // foreground lies in it
    const segmentation::BackgroundModel* room = nullptr;  // the empty room, in the light of now
    float inverse_gain = 1.0F;  // of the picture's luma, to the brightness of the room
};

/// Pictures of another size than the rig's are not of its camera.
inline bool counts(const CameraView& view, const CameraEye& eye) {
    return view.picture.y.data != nullptr && view.mask->width == eye.width() &&
           view.mask->height == eye.height();
}

/// Whether a pixel of a camera that counts shows a person.
inline bool is_person(const CameraView& view, const Eigen::Vector2f& px) {
    return view.mask->at(static_cast<int>(px.x() + 0.5F), static_cast<int>(px.y() + 0.5F)) != 0;
}

}  // namespace atrium::camouflage
