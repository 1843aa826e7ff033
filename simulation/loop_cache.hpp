#pragma once

#include "simulation/simulated_loop.hpp"

namespace atrium::simulation {

/// Loads the loop of these cameras and options from `file`. Bytes are untrusted: rejects a file
/// with an unexpected size, key or checksum. The pictures stay in the mapped file
/// (mapped_file.hpp), or are read into memory if it cannot be mapped under a lease.
Expected<SimulatedLoop> read_cached_loop(const std::filesystem::path& file,
                                         std::span<const geometry::CalibratedCamera> cameras,
                                         const RoomOptions& options);

/// Writes the loop atomically, then removes the oldest loops of the folder beyond
/// `kMaxCachedLoops`.
Expected<void> write_cached_loop(const std::filesystem::path& file,
                                 std::span<const geometry::CalibratedCamera> cameras,
                                 const RoomOptions& options,
                                 const SimulatedLoop& loop);

}  // namespace atrium::simulation
