#pragma once

#include "bench/scale/coded_stream.hpp"
#include "core/base/expected.hpp"

#include <cstddef>

// Streams of extreme guests that are still valid on the bus.
namespace atrium::bench {

/// Repeats the stream's textures until there are `num_cameras` (at most 64).
void repeat_cameras(std::size_t num_cameras, CodedStream& stream);

/// Splits each triangle of the meshes into four, `times` times.
Expected<void> subdivide_meshes(int times, CodedStream& stream);

/// Cameras like no real lens, some inside the person and some out of sight. The meshes are far
/// away, huge, tiny and flat in turn.
Expected<void> make_absurd(CodedStream& stream);

}  // namespace atrium::bench
