#pragma once

#include "core/base/expected.hpp"

namespace atrium::gl {

using EntryPoint = void (*)();
using EntryPointLoader = EntryPoint (*)(const char* name);

/// Fills the table of OpenGL 3.3 core functions through `loader` (glfwGetProcAddress,
/// OSMesaGetProcAddress). A context that `loader` belongs to must be current on the calling thread.
/// `OffscreenContext::create` does it by itself.
///
/// The table is one per process, for that is how the generated loader works. OSMesa's functions
/// find the context of the calling thread by themselves, so any number of offscreen contexts may be
/// in use at once, on any threads. Contexts of a window and offscreen contexts may exist in one
/// process only one after the other: loading through another loader redirects every call, so all
/// work in contexts of the former one must be over, their GL objects destroyed. Thread-safe;
/// loading again through the same loader changes nothing.
Expected<void> load_entry_points(EntryPointLoader loader);

}  // namespace atrium::gl
