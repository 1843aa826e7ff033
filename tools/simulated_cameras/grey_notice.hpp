#pragma once

#include <optional>
#include <string>

namespace atrium::simulated_cameras {

/// A region of a sensor and its pixel format, by its GenICam name.
struct PictureRequest {
    int width = 0;
    int height = 0;
    int x = 0;
    int y = 0;
    std::string format;

    bool operator==(const PictureRequest&) const = default;
};

/// Words the warning of a camera that sends grey because a client asks for a picture that it lacks.
class GreyNotice {
public:
    /// Returns the warning with its likely cause, or nothing if the last request was the same.
    /// `sensor` is the whole picture that the camera has.
    std::optional<std::string> look(const std::string& camera,
                                    const PictureRequest& asked,
                                    const PictureRequest& sensor);

private:
    PictureRequest last_;
};

}  // namespace atrium::simulated_cameras
