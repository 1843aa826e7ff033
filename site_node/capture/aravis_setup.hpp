#pragma once

#include "core/base/expected.hpp"
#include "core/image/raw_image.hpp"
#include "site_node/capture/aravis_handle.hpp"
#include "site_node/capture/camera_settings.hpp"

#include <string>
#include <vector>

namespace atrium::capture {

/// Settings that the site requests from one camera.
struct SetupRequest {
    CameraSettings settings;
    TriggerMode trigger = TriggerMode::kSoftware;
    double rate_hz = 30.0;
    int width = 0;  // from the rig [px]; 0: the region of the settings, else the whole sensor
    int height = 0;
};

/// Picture format agreed with a camera.
struct CameraFormat {
    image::PixelFormat format = image::PixelFormat::kMono8;
    ArvPixelFormat arv_format = 0;
    int width = 0;
    int height = 0;
    std::size_t payload_bytes = 0;  // of one picture
    int packet_bytes = 0;           // 0: not GigE Vision
    bool has_ptp = false;           // PTP is enabled
};

/// Sets a camera up before its stream is created. A setting that the camera lacks is an error
/// (kConfiguration, with key and feature) if `request` requires it, else a line in `warnings`.
Expected<CameraFormat> set_up_camera(ArvCamera& camera,
                                     const SetupRequest& request,
                                     std::vector<std::string>& warnings);

/// Converts the pixel format. Error kConfiguration if the site cannot use it.
Expected<image::PixelFormat> pixel_format_of(ArvPixelFormat format, const std::string& name);

}  // namespace atrium::capture
