#pragma once

#include "core/base/expected.hpp"

namespace atrium::gl {

using EntryPoint = void (*)();
using EntryPointLoader = EntryPoint (*)(const char* name);

/// Fills the table of OpenGL 3.3 core functions through `loader` (glfwGetProcAddress,
/// OSMesaGetProcAddress, eglGetProcAddress). A context that `loader` belongs to must be current on
/// the calling thread. `OffscreenContext::create` and `EglContext::create` do it by themselves.
///
/// The table is one per process, for that is how the generated loader works. The functions find the
/// context of the calling thread by themselves, so any number of contexts of one kind may be in use
/// at once, on any threads. Contexts of a window, of OSMesa and of EGL may exist in one process
/// only one after the other: loading through another loader redirects every call, so all work in
/// contexts of the former one must be over, their GL objects destroyed. Thread-safe; loading again
/// through the same loader changes nothing.
Expected<void> load_entry_points(EntryPointLoader loader);

}  // namespace atrium::gl
