#pragma once

#include "core/app/program.hpp"

#include <cstdint>
#include <filesystem>
#include <string>

namespace atrium::bench {

/// Common options of the benchmarks that film acts with the cameras of a simulated room.
struct TrialOptions {
    std::filesystem::path rig = ATRIUM_SOURCE_DIR "/deploy/rigs/full_body_1mp.toml";
    std::uint64_t num_trials = 20;
    std::uint64_t first = 0;  // seed
    std::string only;         // beginnings of names, separated by commas; empty: all
    bool traces = false;

    bool wants(const std::string& name) const;
};

/// Reads the command line of these benchmarks. `options` holds the defaults.
app::Start start(const app::ProgramInfo& info, TrialOptions& options, int argc, char** argv);

}  // namespace atrium::bench
