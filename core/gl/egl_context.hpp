#pragma once

#include "core/base/expected.hpp"

#include <cstdint>
#include <memory>
#include <string>

namespace atrium::gl {

/// Which of the machine's devices may draw.
enum class EglDevices : std::uint8_t {
    kHardware,
    kAny  // Mesa's software renderer as well, where no hardware can be had
};

/// An OpenGL 3.3 core context without display or window, through EGL: of a GPU, mostly.
///
/// It is current on at most one thread, that which made it at first; GL objects made in it are used
/// and destroyed while it is current there. Several may exist at once, but beside contexts of
/// OSMesa and of windows only one after the other: see `load_entry_points`.
class EglContext {
public:
    /// Creates a context on the first device that can have one, hardware first, and makes it
    /// current on the calling thread. Error kUnavailable, with each device's reason, if none can;
    /// where no device comes into question, contexts of others are left as they are.
    static Expected<EglContext> create(EglDevices devices);

    EglContext(EglContext&&) noexcept;
    EglContext& operator=(EglContext&&) noexcept;
    ~EglContext();

    /// Binds the context to the calling thread, in place of the one that was current there.
    Expected<void> make_current();

    /// Leaves the calling thread without a context, so that another thread may take this one.
    void release();

    bool is_hardware() const;

private:
    struct Impl;
    explicit EglContext(std::unique_ptr<Impl> impl);

    std::unique_ptr<Impl> impl_;
};

}  // namespace atrium::gl
