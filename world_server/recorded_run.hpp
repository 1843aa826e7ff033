#pragma once

#include "core/base/expected.hpp"
#include "world_server/config.hpp"

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <stop_token>

namespace atrium::world_server {

/// Where a run is, or was at its end.
struct RecordedState {
    std::uint64_t tick = 0;  // since the beginning of the recording
    double seconds = 0.0;    // recorded time
    std::uint64_t hash = 0;  // physics::World::state_hash
};

/// What a run has done.
struct RecordedCounts {
    std::uint64_t num_meshes = 0;         // of people, used
    std::uint64_t num_rejected = 0;       // samples, meshes, commands and edits
    std::uint64_t num_damaged = 0;        // chunks that could not be read
    std::uint64_t num_contact_ticks = 0;  // in which people touched objects
};

/// Runs a world without a bus, with the people and commands of a recording.
///
/// A sample counts from the first tick at or after its recorded time, and each tick waits until
/// what counts is prepared. The states hence depend only on the recording and the world file, not
/// on the speed of the machine, its load or the number of threads. The state file is neither read
/// nor written; commands and edits that save or restore are left out. Sites that the world file
/// does not name stand where they stood in the recording.
class RecordedRun {
public:
    /// Builds the world. Fails as WorldFile::open, with kInvalidData if the recording has no site,
    /// and if `config.recording.output` exists or cannot be written.
    static Expected<std::unique_ptr<RecordedRun>> create(const WorldServerConfig& config);
    ~RecordedRun();
    RecordedRun(const RecordedRun&) = delete;
    RecordedRun& operator=(const RecordedRun&) = delete;

    /// Runs to the end of the recording, to `config.seconds` of it, or until a stop is requested.
    /// Calls `on_second` after each recorded second and returns the last state. Fails if the output
    /// could not be written, which ends the run, or if the recording had no mesh that could be
    /// read. The output is complete up to the end in any case. Call once.
    Expected<RecordedState> run(std::stop_token stop,
                                const std::function<void(const RecordedState&)>& on_second = {});

    RecordedCounts counts() const;
    /// Of the part that is run [s].
    double duration_s() const;

private:
    struct Impl;
    explicit RecordedRun(std::unique_ptr<Impl> impl);
    std::unique_ptr<Impl> impl_;
};

/// Checks the files of the options, as `create` would. Nothing to check without a recording.
Expected<void> check_recording(const RecordingOptions& options);

/// Runs it and logs progress and result: the program.
Expected<void> run_recorded(const WorldServerConfig& config, std::stop_token stop);

}  // namespace atrium::world_server
