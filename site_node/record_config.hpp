#pragma once

#include "core/config/option_set.hpp"
#include "core/config/rig.hpp"
#include "site_node/record/raw_recorder.hpp"
#include "site_node/source/capture_config.hpp"

#include <filesystem>
#include <string>

namespace atrium::site_node {

/// Recording of what the cameras deliver: `[record]`.
struct RecordConfig {
    std::filesystem::path folder;  // empty: nothing is recorded
    std::filesystem::path
        orders;                  // recordings that others ask for become folders in it; empty: none
    std::string codec = "auto";  // "auto", "raw", "huffyuv" or "ffv1"
    double queue_s = 1.0;        // pictures that wait for the disk
    double pre_roll_s = 0.0;
    int memory_mb = 1024;    // limit for both
    int min_free_mb = 1024;  // the recording ends before the disk has less
    int threads = 0;         // that compress and write; 0: by the codec
};

/// Declares `record.*`; `config` must outlive `set`.
void declare(RecordConfig& config, config::OptionSet& set);

/// Options of the recorder for pictures of this source at this rate.
record::RecorderOptions recorder_options(const RecordConfig& config,
                                         const CaptureConfig& capture,
                                         const config::Rig& rig,
                                         double rate_hz);

}  // namespace atrium::site_node
