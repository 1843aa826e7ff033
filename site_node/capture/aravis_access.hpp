#pragma once

#include "core/base/expected.hpp"
#include "site_node/capture/aravis_handle.hpp"
#include "site_node/capture/camera_discovery.hpp"

#include <memory>

namespace atrium::capture {

/// Opens a camera that was found and takes control of it. Error kUnavailable.
Expected<GPtr<ArvCamera>> open_camera(const FoundCamera& found);

/// True where the camera still obeys this process.
bool is_under_control(ArvCamera& camera);

/// True once the camera's clock runs with the master of its PTP domain.
bool is_ptp_locked(ArvCamera& camera);

/// Lets go of something that belongs to a camera which no longer answers, on a thread of its own:
/// Aravis tries to say goodbye for several seconds. What is still there when the program ends, ends
/// with it.
void release_in_background(std::shared_ptr<void> dead);

}  // namespace atrium::capture
