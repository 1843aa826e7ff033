#pragma once

#include "core/base/expected.hpp"

#include <memory>

namespace atrium::gl {

/// An OpenGL 3.3 core context without display or window: Mesa's software renderer (OSMesa).
///
/// Each object is a context of its own; nothing is shared between them. A context is current on at
/// most one thread, and GL objects made in it must be used and destroyed while it is current there.
/// Several contexts on different threads may work at the same time; see `load_entry_points` for
/// those of OSMesa beside a window's or EGL's.
class OffscreenContext {
public:
    /// Creates a context and makes it current on the calling thread. `width` by `height` is the
    /// size of its default framebuffer [px]. Error kUnavailable if there is no such context here.
    static Expected<OffscreenContext> create(int width, int height);

    OffscreenContext(OffscreenContext&&) noexcept;
    OffscreenContext& operator=(OffscreenContext&&) noexcept;
    ~OffscreenContext();

    /// Binds the context to the calling thread, in place of the one that was current there.
    Expected<void> make_current();

    /// Leaves the calling thread without a context, so that another thread may take this one.
    void release();

    /// Gives the default framebuffer another size; what it held is lost. The context becomes
    /// current.
    Expected<void> resize(int width, int height);

    int width() const;
    int height() const;

private:
    struct Impl;
    explicit OffscreenContext(std::unique_ptr<Impl> impl);

    std::unique_ptr<Impl> impl_;
};

}  // namespace atrium::gl
