#pragma once

#include "core/base/expected.hpp"

#include <cstdint>
#include <memory>
#include <string>

namespace atrium::gl {

/// Selects the devices that may render.
enum class EglDevices : std::uint8_t {
    kHardware,
    kAny  // Mesa's software renderer as well, if no hardware is available
};

/// An OpenGL 3.3 core context through EGL, without display or window; usually of a GPU.
///
/// It is current on at most one thread, at first the one that created it. Use and destroy its GL
/// objects while it is current. Several may exist at once, but not together with contexts of OSMesa
/// or windows: see `load_entry_points`.
class EglContext {
public:
    /// Creates a context on the first suitable device, hardware first, and makes it current on the
    /// calling thread. Fails with kUnavailable and each device's reason if there is none. Without
    /// candidates it does not touch other contexts.
    static Expected<EglContext> create(EglDevices devices);

    EglContext(EglContext&&) noexcept;
    EglContext& operator=(EglContext&&) noexcept;
    ~EglContext();

    /// Makes the context current on the calling thread. Fails with kUnavailable.
    Expected<void> make_current();

    /// Leaves the calling thread without a current context; another thread may then use this one.
    void release();

    bool is_hardware() const;

private:
    struct Impl;
    explicit EglContext(std::unique_ptr<Impl> impl);

    std::unique_ptr<Impl> impl_;
};

}  // namespace atrium::gl
