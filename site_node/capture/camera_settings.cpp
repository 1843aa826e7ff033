#include "site_node/capture/camera_settings.hpp"

namespace atrium::capture {

CameraSettings merged(const CameraSettings& common, const CameraSettings& own) {
    static const CameraSettings kUnset;
    CameraSettings result = common;
    const auto take = [&](auto member) {
        if (own.*member != kUnset.*member) result.*member = own.*member;
    };
    take(&CameraSettings::pixel_format);
    take(&CameraSettings::exposure_us);
    take(&CameraSettings::gain_db);
    take(&CameraSettings::white_balance);
    take(&CameraSettings::trigger_source);
    take(&CameraSettings::packet_size);
    take(&CameraSettings::packet_delay_ns);
    take(&CameraSettings::region_px);
    return result;
}

const std::vector<std::string>& camera_pixel_formats() {
    static const std::vector<std::string> kNames{"Mono8",
                                                 "BayerRG8",
                                                 "BayerGR8",
                                                 "BayerGB8",
                                                 "BayerBG8",
                                                 "RGB8",
                                                 "BGR8",
                                                 "YUV422_8",
                                                 "YUV422_8_UYVY"};
    return kNames;
}

}  // namespace atrium::capture
