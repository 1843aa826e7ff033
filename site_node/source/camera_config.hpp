#pragma once

#include "core/config/option_set.hpp"
#include "core/config/table_reader.hpp"
#include "site_node/capture/camera_settings.hpp"

#include <string>

namespace atrium::site_node {

/// Options of `[capture]` that concern cameras.
struct CameraConfig {
    std::string trigger = "software";
    capture::CamerasOptions options;  // the rest; its deadline and min_cameras are unused
};

/// Declares `capture.trigger` and `capture.cameras.*`; `config` must outlive `set`.
void declare(CameraConfig& config, config::OptionSet& set);

/// Reads every `[[capture.camera]]`. `reader` collects the errors.
void read_cameras(config::TableReader& reader, CameraConfig& config);

/// Checks rules that span several options.
Expected<void> check(const CameraConfig& config);

/// Combines `config` with the two values that it lacks into the options of an AravisSource.
capture::CamerasOptions cameras_options(const CameraConfig& config,
                                        std::size_t min_cameras,
                                        std::chrono::nanoseconds deadline);

}  // namespace atrium::site_node
