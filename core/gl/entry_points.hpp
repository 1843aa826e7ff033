#pragma once

#include "core/base/expected.hpp"

namespace atrium::gl {

using EntryPoint = void (*)();
using EntryPointLoader = EntryPoint (*)(const char* name);

/// Loads the OpenGL 3.3 core functions with `loader` (glfwGetProcAddress, OSMesaGetProcAddress,
/// eglGetProcAddress). A context of that kind must be current on the calling thread.
/// `OffscreenContext::create` and `EglContext::create` call it themselves. Fails with kUnavailable
/// if the driver has no OpenGL 3.3.
///
/// The generated loader has one table of functions per process. The functions use the context of
/// the calling thread: any number of contexts of one kind can be in use at once, on any threads.
/// Contexts of a window, OSMesa and EGL can exist in a process only one kind after the other,
/// because another loader redirects every call: first finish all work in the earlier contexts and
/// destroy their GL objects. Thread-safe; loading again with the same loader does nothing.
Expected<void> load_entry_points(EntryPointLoader loader);

}  // namespace atrium::gl
