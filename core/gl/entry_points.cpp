#include "core/gl/entry_points.hpp"

#include <glad/gl.h>

#include <mutex>

namespace atrium::gl {
namespace {

// Guard and describe the table of the generated loader, which is global too.
std::mutex table_mutex;
EntryPointLoader table_loader = nullptr;

}  // namespace

Expected<void> load_entry_points(EntryPointLoader loader) {
    const std::lock_guard lock(table_mutex);
    if (loader == table_loader) return {};
    const int version = gladLoadGL(loader);
    if (version < GLAD_MAKE_VERSION(3, 3)) {
        table_loader = nullptr;
        return make_error(ErrorKind::kUnavailable,
                          "OpenGL: the driver has no version 3.3 core context");
    }
    table_loader = loader;
    return {};
}

}  // namespace atrium::gl
