#pragma once

#include "core/base/expected.hpp"
#include "core/image/raw_image.hpp"
#include "site_node/capture/aravis_handle.hpp"
#include "site_node/capture/camera_settings.hpp"

#include <string>
#include <vector>

namespace atrium::capture {

/// What the site asks of one camera.
struct SetupRequest {
    CameraSettings settings;
    TriggerMode trigger = TriggerMode::kSoftware;
    double rate_hz = 30.0;
    int width = 0;  // of the rig [px]
    int height = 0;
};

/// What was agreed with a camera.
struct CameraFormat {
    image::PixelFormat format = image::PixelFormat::kMono8;
    ArvPixelFormat arv_format = 0;
    int width = 0;
    int height = 0;
    std::size_t payload_bytes = 0;  // of one picture
    int packet_bytes = 0;           // 0: no GigE Vision
    bool has_ptp = false;           // switched on
};

/// Sets a camera up, before its stream is made. What the camera lacks is an error (kConfiguration,
/// naming key and feature) where `request` asks for it, else a line in `warnings`.
Expected<CameraFormat> set_up_camera(ArvCamera& camera,
                                     const SetupRequest& request,
                                     std::vector<std::string>& warnings);

/// The format of these pictures; error kConfiguration for those that the site cannot use.
Expected<image::PixelFormat> pixel_format_of(ArvPixelFormat format, const std::string& name);

}  // namespace atrium::capture
