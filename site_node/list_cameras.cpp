#include "site_node/list_cameras.hpp"

#include "site_node/capture/camera_discovery.hpp"

#include <fmt/format.h>

#include <cstdio>

namespace atrium::site_node {

Expected<void> list_cameras() {
    const auto cameras = capture::discover_cameras();
    if (cameras.empty()) {
        return make_error(
            ErrorKind::kNotFound,
            "no camera answers. GigE Vision: check its power, that its address is in the network "
            "of an "
            "interface of this machine, and that no firewall blocks UDP port 3956. USB3 Vision: "
            "check "
            "that this user may open the device (udev rules) and that it is at a USB 3 port. "
            "atrium "
            "doctor --for camera checks these");
    }
    fmt::print("{}", capture::camera_table(cameras));
    std::fflush(stdout);
    return {};
}

}  // namespace atrium::site_node
