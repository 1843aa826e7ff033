#pragma once

#include "site_node/capture/aravis_camera.hpp"

#include <memory>

/// Private to aravis_camera*.cpp.
namespace atrium::capture {

/// Connection to one camera.
struct AravisCamera::Session {
    FoundCamera found;
    CameraFormat format;
    std::uint64_t number = 0;
    GPtr<ArvCamera> camera;
    gulong lost_handler = 0;
    std::unique_ptr<AravisStream> stream;
    bool is_untriggered = false;  // and reported as such

    Session() = default;
    Session(const Session&) = delete;
    Session& operator=(const Session&) = delete;
    ~Session() {
        if (lost_handler != 0)
            g_signal_handler_disconnect(arv_camera_get_device(camera.get()), lost_handler);
        stream.reset();  // before its camera
    }

    bool answers() const {
        return found.protocol != "GigEVision" ||
               ask_gige_camera(found.address, std::chrono::milliseconds(200)).has_value();
    }
};

}  // namespace atrium::capture
