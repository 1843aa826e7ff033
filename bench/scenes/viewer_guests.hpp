#pragma once

#include "bench/scale/coded_stream.hpp"
#include "core/base/expected.hpp"

#include <cstddef>

// Guests that are more than a viewer expects: what they send is valid on the bus.
namespace atrium::bench {

/// The stream's textures again and again, until there are `num_cameras` (at most 64).
void repeat_cameras(std::size_t num_cameras, CodedStream& stream);

/// Each triangle of the meshes cut into four, `times` over.
Expected<void> subdivide_meshes(int times, CodedStream& stream);

/// Cameras that no lens is like, some inside the person and some out of sight, and meshes that are
/// far away, huge, tiny and flat in turns.
Expected<void> make_absurd(CodedStream& stream);

}  // namespace atrium::bench
