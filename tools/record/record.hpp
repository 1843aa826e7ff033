#pragma once

#include "core/base/expected.hpp"
#include "core/bus/bus.hpp"
#include "core/config/option_set.hpp"

#include <cstdint>
#include <filesystem>
#include <stop_token>
#include <string>

/// Records a world into MCAP files.
namespace atrium::record_tool {

struct RecordConfig {
    bus::BusOptions bus;
    std::filesystem::path output;  // empty: WORLD-YYYYMMDD-HHMMSS.mcap in the current folder
    std::string site;              // with `raw`
    std::string raw;               // record the pictures of `site` into this folder of its host
    bool stop = false;             // end the recording of `site`
    std::string sites;             // "a,b"; empty: all
    std::string topics;            // likewise
    double seconds = 0.0;          // 0: until Ctrl-C
    double cut_mb = 0.0;           // 0: one file
    double cut_s = 0.0;
    std::uint32_t buffer_mb = 64;
    std::uint32_t spare_disk_mb = 64;
};

void declare(RecordConfig& config, config::OptionSet& options);
Expected<void> check(const RecordConfig& config);

/// Records until the stop. kNotFound if nothing came.
Expected<void> run_record(const RecordConfig& config, std::stop_token stop);

}  // namespace atrium::record_tool
