#pragma once

#include "simulation/simulated_loop.hpp"

namespace atrium::simulation {

/// The loop in `file`, if the file is whole, undamaged and made from these cameras and options. The
/// bytes are untrusted: nothing is taken from a file whose size, key or checksum is not as
/// expected. The pictures stay in the file, mapped (mapped_file.hpp), or are read into memory where
/// it cannot be mapped under a lease.
Expected<SimulatedLoop> read_cached_loop(const std::filesystem::path& file,
                                         std::span<const geometry::CalibratedCamera> cameras,
                                         const RoomOptions& options);

/// Writes beside `file` and renames, so that a reader sees the whole file or none; then removes the
/// oldest loops of the folder beyond `kMaxCachedLoops`.
Expected<void> write_cached_loop(const std::filesystem::path& file,
                                 std::span<const geometry::CalibratedCamera> cameras,
                                 const RoomOptions& options,
                                 const SimulatedLoop& loop);

}  // namespace atrium::simulation
