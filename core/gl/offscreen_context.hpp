#pragma once

#include "core/base/expected.hpp"

#include <memory>

namespace atrium::gl {

/// An OpenGL 3.3 core context of Mesa's software renderer (OSMesa), without display or window.
///
/// Contexts do not share objects. A context is current on at most one thread. Use and destroy its
/// GL objects while it is current. Several contexts on different threads can work at the same time,
/// but not together with contexts of a window or EGL: see `load_entry_points`.
class OffscreenContext {
public:
    /// Creates a context and makes it current on the calling thread. `width` by `height` is the
    /// size of its default framebuffer [px]. Fails with kUnavailable.
    static Expected<OffscreenContext> create(int width, int height);

    OffscreenContext(OffscreenContext&&) noexcept;
    OffscreenContext& operator=(OffscreenContext&&) noexcept;
    ~OffscreenContext();

    /// Makes the context current on the calling thread. Fails with kUnavailable.
    Expected<void> make_current();

    /// Leaves the calling thread without a current context; another thread may then use this one.
    void release();

private:
    struct Impl;
    explicit OffscreenContext(std::unique_ptr<Impl> impl);

    std::unique_ptr<Impl> impl_;
};

}  // namespace atrium::gl
