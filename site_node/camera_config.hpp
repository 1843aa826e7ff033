#pragma once

#include "core/config/option_set.hpp"
#include "core/config/table_reader.hpp"
#include "site_node/capture/camera_settings.hpp"

#include <string>

namespace atrium::site_node {

/// What `[capture]` says of cameras.
struct CameraConfig {
    std::string trigger = "software";
    capture::CamerasOptions options;  // what is not above; its deadline and min_cameras are unused
};

/// Declares `capture.trigger` and `capture.cameras.*`; `config` must
/// outlive `set`.
void declare(CameraConfig& config, config::OptionSet& set);

/// `[[capture.camera]]`. Problems are kept by `reader`.
void read_cameras(config::TableReader& reader, CameraConfig& config);

/// What options cannot check one by one.
Expected<void> check(const CameraConfig& config);

/// All of it, for the source.
capture::CamerasOptions cameras_options(const CameraConfig& config,
                                        std::size_t min_cameras,
                                        std::chrono::nanoseconds deadline);

}  // namespace atrium::site_node
