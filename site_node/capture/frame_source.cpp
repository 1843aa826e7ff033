#include "site_node/capture/frame_source.hpp"

#include <string>

namespace atrium::capture {

Expected<CameraFrame> FrameSource::read_picture(std::size_t /*camera*/, std::size_t index) {
    return make_error(ErrorKind::kNotFound, "there is no picture " + std::to_string(index));
}

std::vector<Expected<void>> one_after_another(
    const std::vector<std::size_t>& cameras,
    const std::function<Expected<void>(std::size_t camera)>& show,
    const std::stop_token& stop) {
    std::vector<Expected<void>> results;
    for (const std::size_t camera : cameras) {
        const bool is_too_late = stop.stop_requested();
        Expected<void> shown = is_too_late ? Expected<void>() : show(camera);
        // a result cut short by the stop must not count as complete
        if (is_too_late || (shown && stop.stop_requested()))
            shown = make_error(ErrorKind::kUnavailable, "stopped");
        results.push_back(std::move(shown));
    }
    return results;
}

}  // namespace atrium::capture
