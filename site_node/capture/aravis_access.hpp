#pragma once

#include "core/base/expected.hpp"
#include "site_node/capture/aravis_handle.hpp"
#include "site_node/capture/camera_discovery.hpp"

#include <memory>

namespace atrium::capture {

/// Opens a discovered camera and takes control of it. Error kUnavailable.
Expected<GPtr<ArvCamera>> open_camera(const FoundCamera& found);

/// Returns true while this process still controls the camera.
bool is_under_control(ArvCamera& camera);

/// Returns true once the camera follows, or is, the master clock of its PTP domain.
bool is_ptp_locked(ArvCamera& camera);

/// Destroys `dead`, which belongs to a camera that no longer answers, on a background thread:
/// Aravis tries for several seconds to end the connection. Objects not destroyed when the program
/// ends are leaked.
void release_in_background(std::shared_ptr<void> dead);

}  // namespace atrium::capture
